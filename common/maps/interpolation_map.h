// A map as it is served: P(x) = Σ q φ(x) (A.11) with coefficients packed for each element, its
// gradient (6.13), and an error estimate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "common/maps/packed_coefficients.h"
#include "common/maps/refinement_tree.h"

namespace mortise::maps {

// All that a map is made of: what is stored.
struct MapContent {
  int dimension = 0;
  Basis basis = Basis::kLinear;
  RefinementOptions options{};
  std::vector<ElementSplit> splits{};  // of RefinementTree::history
  // outputs × samples; zero where a sample failed. There may be no outputs: the map then says where
  // it has a value, and tree() with which weights (PackedWeights) others interpolate.
  Eigen::MatrixXd values{};
  // For each element, in the order of RefinementTree::Elements:
  Eigen::MatrixXd errors{};             // outputs × elements: the largest difference known there
  std::vector<std::uint8_t> cut_off{};  // 1 where the map has no value
};

// What a map says of n points.
struct MapValues {
  Eigen::MatrixXd values;     // outputs × n, NaN where the map is cut off
  Eigen::MatrixXd errors;     // outputs × n: of the element that the point lies in; infinite there
  Eigen::MatrixXd gradients;  // (outputs · K) × n, output by output; empty unless asked for
};

// Immutable; any number of threads may call it at once.
class InterpolationMap {
 public:
  // INVALID_ARGUMENT, field `splits…`, `values`, `errors`, `cut_off`: not a map.
  static absl::StatusOr<InterpolationMap> Create(MapContent content);

  const MapContent& content() const { return content_; }
  int dimension() const { return content_.dimension; }
  int outputs() const { return static_cast<int>(content_.values.rows()); }
  const RefinementTree& tree() const { return tree_; }

  // The bytes that evaluation reads from, all elements together.
  std::size_t packed_bytes() const { return packed_.bytes(); }
  // How many of them Evaluate reads for these points (K × n), for benches.
  std::size_t BytesRead(const Eigen::Ref<const Eigen::MatrixXd>& points) const;

  // Returns q of each B-spline of the tree (A.11), outputs × tree().splines().count(), zero where
  // one is not active. They are computed anew.
  Eigen::MatrixXd Coefficients() const;

  // points: K × n, in the unit box; coordinates outside of it are taken to its faces. Not finite
  // ones give NaN. Gradients are by the coordinates of the unit box.
  MapValues Evaluate(const Eigen::Ref<const Eigen::MatrixXd>& points, bool gradients = false) const;

  // The same for one point, without allocation: writes outputs() numbers to `values`, as many to
  // `errors` and outputs() · K to `gradient`, the latter two unless null. Returns whether the map
  // has a value there; where not, nothing is written.
  bool EvaluateOne(const double* point, double* values, double* errors, double* gradient) const;

 private:
  InterpolationMap(MapContent content, RefinementTree tree);

  // A node of the tree as it is read on the way to a point's element: 16 bytes.
  struct Turn {
    double middle = 0;  // of the split
    int next = 0;  // the lower child, the upper one follows; in an element its order in Elements()
    int direction = -1;  // of the split, -1 in an element
  };

  MapContent content_;
  RefinementTree tree_;
  std::vector<Turn> turns_;  // for each node
  PackedCoefficients packed_;
};

}  // namespace mortise::maps
