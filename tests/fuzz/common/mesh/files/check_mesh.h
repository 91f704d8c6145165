// What holds of every mesh that is read, and of every refusal.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "common/base/errors.h"
#include "common/mesh/files/grouped_mesh.h"

namespace mortise::mesh {

inline void CheckRead(const absl::StatusOr<GroupedMesh>& mesh) {
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  if (!mesh.ok()) {
    require(absl::IsInvalidArgument(mesh.status()));
    require(DetailOf(mesh.status()).field == "mesh_file");
    return;
  }
  const int nodes = static_cast<int>(mesh->nodes.cols());
  const int elements = static_cast<int>(mesh->tetrahedra.cols());
  require(elements > 0 && (mesh->tetrahedra.rows() == 4 || mesh->tetrahedra.rows() == 10));
  require(mesh->nodes.allFinite());
  require(mesh->tetrahedra.minCoeff() >= 0 && mesh->tetrahedra.maxCoeff() < nodes);
  require(mesh->node_numbers.size() == static_cast<std::size_t>(nodes));
  require(mesh->element_numbers.size() == static_cast<std::size_t>(elements));
  const auto require_ascending = [&](const auto& members) {
    require(std::adjacent_find(members.begin(), members.end(), std::greater_equal<>()) ==
            members.end());
  };
  for (const ElementGroup& group : mesh->element_groups) {
    require_ascending(group.members);
    for (const int e : group.members) require(e >= 0 && e < elements);
  }
  for (const NodeGroup& group : mesh->node_groups) {
    require_ascending(group.members);
    for (const int v : group.members) require(v >= 0 && v < nodes);
  }
  for (const FaceGroup& group : mesh->face_groups) {
    require_ascending(group.members);
    for (const ElementSide& side : group.members) {
      require(side.element >= 0 && side.element < elements && side.side >= 0 && side.side < 4);
      require(SideNodes(mesh->tetrahedra, side).minCoeff() >= 0);
    }
  }
}

}  // namespace mortise::mesh
