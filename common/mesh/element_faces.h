// Finds the triangles between elements of a volume mesh, and the elements on their sides.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

// The corners of the four faces of a tetrahedron, outward, with face i opposite corner i.
inline constexpr std::array<std::array<int, 3>, 4> kTetrahedronFaces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// The corners of the six edges, in the order of the mid nodes of quadratic elements.
inline constexpr std::array<std::array<int, 2>, 6> kTetrahedronEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

// A face of an element.
struct ElementFace {
  std::array<int, 3> key;  // corner nodes, ascending
  int element = -1;
  int side = -1;  // index into kTetrahedronFaces
};

// All faces of all elements, findable by their corners.
class ElementFaces {
 public:
  explicit ElementFaces(const TetrahedralMesh& mesh);

  // Returns the triangle with these corners as the element of `part` sees it: outward of that
  // element. Returns nothing if no element of the part has it.
  std::optional<Eigen::Vector3i> FaceSeenFrom(const Eigen::Vector3i& corners, int part) const;

  // Returns the faces that only one element has.
  std::vector<ElementFace> Outer() const;

 private:
  const TetrahedralMesh& mesh_;
  std::vector<ElementFace> faces_;  // by key
};

}  // namespace mortise::mesh
