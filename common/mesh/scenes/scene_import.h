// Reads mesh files in the process that calls: for the child of scene_reader.h, tests and fuzzers.
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "common/mesh/scenes/scene.h"

namespace mortise::mesh {

// As ReadScene (scene_reader.h), without its limits of memory and time. libassimp may crash over a
// damaged file, and the process with it. One call at a time in a process, as libassimp has one log.
absl::StatusOr<Scene> ImportScene(std::string_view bytes, std::string_view file_name);

}  // namespace mortise::mesh
