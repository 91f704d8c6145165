// Has libassimp read a cleaned file.
#pragma once

#include "absl/status/statusor.h"
#include "common/mesh/scenes/cleaning/cleaned_file.h"
#include "common/mesh/scenes/scene.h"

namespace mortise::mesh {

// Returns the components of the file, with the transforms of their nodes applied; unit and up axis
// are not set. Vertices at one place are one; degenerate triangles, and vertices that none uses,
// are left out; notes say so. Errors as of ReadScene.
absl::StatusOr<Scene> ReadByAssimp(const CleanedFile& file);

}  // namespace mortise::mesh
