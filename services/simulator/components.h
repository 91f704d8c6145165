// Sets of parts that hang together.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// One set of nodes that elements connect, and the parts they belong to.
struct Component {
  std::set<int> parts;
  std::vector<int> nodes;  // ascending
};

// In the order of their first nodes. A node of no element is a component without parts.
std::vector<Component> FindComponents(const mesh::TetrahedralMesh& mesh);

// Where the middle of its nodes is: "near (1, 2, 3) mm".
std::string PlaceText(const Component& component, const mesh::TetrahedralMesh& mesh);

// "part 'leg 3' is", or "parts 'top', 'apron', 'leg', 'shelf' and 3 more are".
std::string PartsText(const Component& component, const mesh::TetrahedralMesh& mesh);

}  // namespace mortise::simulator
