// Makes parts of a mesh: the first step from a single mesh to a parametric assembly (thesis §4.6.1
// and §3.2.2).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/parts/part_grouping.h"
#include "common/mesh/scenes/scene.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

struct ScenePart {
  std::string name;     // of its component, numbered where that has several parts; may be empty
  std::string group;    // name of its component where that has a name and several parts; else empty
  SurfaceMesh surface;  // in the scene's unit
  // The first part that is the same but for its place, to a hundred thousandth of the scene's
  // diagonal; its own index if it is that.
  int first_alike = 0;
  bool has_gap = false;  // whether it touches some part only to within PartGroupingOptions::contact
};

struct SceneParts {
  std::vector<ScenePart> parts;    // in the order of the scene
  std::vector<std::string> notes;  // whole sentences, for people
};

// Returns the parts of a scene: its pieces (surface_pieces.h), grouped (part_grouping.h). A
// component of one piece is a part of its name; of one that has several parts these are numbered,
// and are a group. Where no two components have names, groups are none. `most_parts`: at least 1.
//
// INVALID_ARGUMENT, "file": there is no triangle with an area, or all lie in one plane.
absl::StatusOr<SceneParts> PartsOf(const Scene& scene, std::size_t most_parts);

}  // namespace mortise::mesh
