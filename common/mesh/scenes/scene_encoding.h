// A scene as bytes, by which the process that reads a file hands it to the one that asked.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/mesh/scenes/scene.h"

namespace mortise::mesh {

// Little-endian, with coordinates to the bit.
std::string EncodeScene(const Scene& scene);

// The same scene. INTERNAL for bytes that are no encoded scene, or whose triangles name vertices
// that are not there: the other process is not trusted.
absl::StatusOr<Scene> DecodeScene(std::string_view bytes);

}  // namespace mortise::mesh
