// Finds groups of an uploaded mesh by name, and makes the faces that conditions act on.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// All failures are INVALID_ARGUMENT naming "<field>.groups[i]": an unknown group with the most
// similar name, one of another kind, an empty one. `names` has been checked to be short.
class MeshGroups {
 public:
  using Names = std::vector<std::string>;

  explicit MeshGroups(const mesh::GroupedMesh& mesh) : mesh_(mesh) {}

  // Returns the elements of all groups together, ascending.
  absl::StatusOr<std::vector<int>> Elements(const Names& names, const std::string& field) const;

  // Returns the nodes of all groups together, ascending: from groups of faces their faces' nodes,
  // middle ones included. Where faces and nodes have groups of one name, it is the faces'.
  absl::StatusOr<std::vector<int>> Nodes(const Names& names, const std::string& field) const;

  // Returns the nodes of groups of nodes only.
  absl::StatusOr<std::vector<int>> OwnNodes(const Names& names, const std::string& field) const;

  // Makes the sides of all groups together a face that conditions can name; the same groups give
  // the same face. With `is_loaded`, INVALID_ARGUMENT if none of it is on the outside.
  absl::StatusOr<mesh::NamedFace> Face(const Names& names, bool is_loaded,
                                       const std::string& field);

  // Writes the faces asked for into `volume`, whose elements and parts are there.
  void TakeFaces(mesh::TetrahedralMesh& volume) const;

 private:
  bool IsOuter(const mesh::ElementSide& side);
  void FindNeighbours();

  const mesh::GroupedMesh& mesh_;
  std::map<std::string, std::vector<mesh::ElementSide>> faces_;  // by name
  std::vector<std::array<int, 4>> neighbours_;  // the element beyond each side, or -1; once needed
};

}  // namespace mortise::simulator
