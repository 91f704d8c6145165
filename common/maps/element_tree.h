// The K-d tree of a map: its elements, and the samples at the corners of every common cuboid
// (thesis 6.4 and step 1 of Algorithm 1). A part of RefinementTree (refinement_tree.h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/maps/lattice.h"

namespace mortise::maps {

// Elements are leaves, which keep the number of their node; node 0 is the whole box. A position is
// a sample if and only if in every direction some element that contains it ends there. That is the
// same as being a corner of the intersection of some elements (Definition 7): the intersection of
// all elements around the position is then bounded by it in every direction.
class ElementTree {
 public:
  explicit ElementTree(int dimension);

  int dimension() const { return dimension_; }
  int node_count() const { return static_cast<int>(nodes_.size()); }
  int element_count() const { return (node_count() + 1) / 2; }
  bool IsElement(int node) const { return nodes_[node].direction < 0; }
  const LatticeBox& BoxOf(int node) const { return nodes_[node].box; }
  // How many splits along `direction` led to the node.
  int DepthOf(int node, int direction) const { return nodes_[node].depth[direction]; }
  int LeastDepthOf(int node) const;
  int MostDepthOf(int node) const;

  // The elements whose closed boxes meet the closed box.
  std::vector<int> Touching(const LatticeBox& box) const;
  // The elements whose interiors meet the interior of the box.
  std::vector<int> Overlapping(const LatticeBox& box) const;
  // N(p): the elements whose closed boxes contain the point.
  std::vector<int> Containing(const RationalPoint& point) const;
  // The intersection of all elements that contain the point (R of Algorithm 1).
  LatticeBox CommonCuboid(const RationalPoint& point) const;
  // The element of a point of the unit box; of two that share it, the upper one.
  int Locate(const double* point) const;

  // The positions that become samples if the element is split halfway along `direction`.
  std::vector<LatticePoint> NewSamples(int element, int direction) const;
  // Splits the element into nodes n and n+1, where n is the node count of before. Returns the
  // numbers of the new samples.
  std::vector<int> Split(int element, int direction);

  int sample_count() const { return static_cast<int>(samples_.size()); }
  const LatticePoint& SampleAt(int sample) const { return samples_[sample]; }
  // The number of the sample at the position, or -1.
  int FindSample(const LatticePoint& position) const;
  // B(e): the samples in the closed box of the element, ascending.
  const std::vector<int>& SamplesOf(int element) const { return nodes_[element].samples; }

 private:
  struct Node {
    LatticeBox box;
    std::array<std::int8_t, kMostDirections> depth{};
    std::int8_t direction = -1;  // of the split, -1 in an element
    std::int32_t middle = 0;     // of the split
    int first_child = -1;
    std::vector<int> samples;
  };

  template <typename Enters>
  std::vector<int> Collect(const Enters& enters) const;
  int AddSample(const LatticePoint& position);

  int dimension_;
  std::vector<Node> nodes_;
  std::vector<LatticePoint> samples_;
  std::unordered_map<LatticePoint, int, LatticeHash> sample_index_;
};

}  // namespace mortise::maps
