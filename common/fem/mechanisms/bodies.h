// Finds the rigid bodies of a mesh: elements that hang together through faces.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// A body is elements that can be reached from each other through faces between neighbours, so that
// none of them can turn against the others without deforming. Bodies may share edges and points.
struct Body {
  std::set<int> parts;
  std::vector<int> nodes;  // ascending; a node may be in several bodies
};

// Returns the bodies in the order of their first elements.
std::vector<Body> FindBodies(const mesh::TetrahedralMesh& mesh);

// Fails with INVALID_ARGUMENT naming "nodes" if a node belongs to no element.
absl::Status CheckNodesAreUsed(const mesh::TetrahedralMesh& mesh);

// Returns where the middle of its nodes is: "near (1, 2, 3) mm".
std::string PlaceText(const Body& body, const mesh::TetrahedralMesh& mesh);

// Returns "part 'leg 3' is", or "parts 'top', 'apron', 'leg', 'shelf' and 3 more are".
std::string PartsText(const std::set<int>& parts, const mesh::TetrahedralMesh& mesh);

// Returns what is told of a body: its parts, and where it is if one of them has further bodies:
// "the piece near (1, 2, 3) mm of part 'leg 3' is".
std::string BodyText(const Body& body, const std::vector<Body>& all,
                     const mesh::TetrahedralMesh& mesh);

}  // namespace mortise::simulator
