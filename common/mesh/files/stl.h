// Writes surfaces as STL files, which every printer and viewer reads.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Returns a binary STL file. STL has no unit; coordinates are written in millimetres, as its
// readers expect. INVALID_ARGUMENT if a triangle names a vertex that does not exist.
absl::StatusOr<std::string> WriteStl(const SurfaceMesh& surface, const std::string& title);

}  // namespace mortise::mesh
