// Finds the faces of elements on the outside of each part, and the edges where they meet at an
// angle.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "common/fem/elements/shape_functions.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Faces that turn by more than this (50 degrees) meet at an edge. The facets of what is round turn
// by less if it has eight or more, and they are then taken for one surface.
inline constexpr double kSharpCosine = 0.643;

// Nodes as each part sees them: across a joint stress may jump, so a node between two parts has a
// slot for each.
class PartNodes {
 public:
  explicit PartNodes(const mesh::TetrahedralMesh& mesh);

  int size() const { return static_cast<int>(node_.size()); }
  int node(int slot) const { return node_[slot]; }
  int part(int slot) const { return part_[slot]; }

  // Returns the slots of an element's nodes: nodes of an element × elements.
  const Eigen::MatrixXi& element_slots() const { return element_slots_; }

  // Returns the elements of the slot's part round its node.
  const int* begin(int slot) const { return around_.data() + first_[slot]; }
  const int* end(int slot) const { return around_.data() + first_[slot + 1]; }

 private:
  std::vector<int> node_, part_;
  Eigen::MatrixXi element_slots_;
  std::vector<int> first_, around_;
};

// A node of a face: 0-2 are its corners, 3-5 the middles of its sides 01, 12, 20.
struct FaceNode {
  int face = -1;
  int place = -1;
};

// Returns the barycentric coordinates of a place of a face.
Eigen::Vector3d FacePlace(int place);

// A side that two faces of a part have in common and where they are not one smooth surface.
struct SharpEdge {
  std::array<FaceNode, 3> first;   // its ends, and of quadratic elements its middle, on one face,
  std::array<FaceNode, 3> second;  // and the same nodes on the other
  bool convex = false;             // the part is on the inner side of both faces
};

// Items of slots, those of each in a row.
template <typename Item>
class BySlot {
 public:
  BySlot() = default;
  // `items` come with the slot of each, in any order; those of a slot stay in theirs.
  BySlot(int slots, const std::vector<std::pair<int, Item>>& items)
      : first_(slots + 1, 0), items_(items.size()) {
    for (const auto& [slot, item] : items) ++first_[slot + 1];
    for (int slot = 0; slot < slots; ++slot) first_[slot + 1] += first_[slot];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (const auto& [slot, item] : items) items_[next[slot]++] = item;
  }

  std::span<const Item> At(int slot) const {
    return std::span(items_).subspan(first_[slot], first_[slot + 1] - first_[slot]);
  }

 private:
  std::vector<int> first_;
  std::vector<Item> items_;
};

class PartSurface {
 public:
  PartSurface(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes);

  int size() const { return static_cast<int>(nodes_.cols()); }  // faces

  // Returns the nodes of each face, 3 or 6 × faces, in the order of FaceNode, counter-clockwise
  // seen from outside.
  const Eigen::MatrixXi& nodes() const { return nodes_; }

  int part(int face) const { return part_[face]; }

  // Whether no element of another part is on its other side.
  bool IsFree(int face) const { return free_[face]; }

  // Returns the face that is free and has these corners, in any order; -1 if there is none.
  int FreeFaceWith(std::array<int, 3> corners) const;

  // Returns the faces of a slot's part that have its node.
  std::span<const FaceNode> At(int slot) const { return at_slot_.At(slot); }

  // Returns the sharp edges of a slot's part that have its node.
  std::span<const int> SharpEdgesAt(int slot) const { return edges_at_slot_.At(slot); }
  const SharpEdge& edge(int index) const { return edges_[index]; }

 private:
  void FindFaces(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes);
  void FindSharpEdges(const mesh::TetrahedralMesh& mesh);

  Eigen::MatrixXi nodes_, slots_;
  std::vector<std::array<int, 3>> corners_;  // ascending; faces are in their order
  std::vector<int> part_;
  std::vector<bool> free_;
  std::vector<SharpEdge> edges_;
  BySlot<FaceNode> at_slot_;
  BySlot<int> edges_at_slot_;
};

// Returns the node positions of a face, 3 × 3 or 3 × 6.
GradientMatrix FacePositions(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                             int face);

}  // namespace mortise::simulator
