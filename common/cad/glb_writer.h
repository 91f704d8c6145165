// Writes assemblies as binary glTF 2.0, the format web viewers open: one named node a part.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

struct GlbPart {
  std::string name;
  mesh::SurfaceMesh surface;                               // m, z upwards
  Eigen::Vector3d color = Eigen::Vector3d(0.8, 0.8, 0.8);  // linear red, green, blue in 0 … 1
};

// Returns the bytes of a GLB file in metres. glTF has y upwards: a root node named `assembly_name`
// turns the design, so that positions in the file stay those of the design. Triangles are flat
// shaded. INVALID_ARGUMENT for an empty or non-finite mesh or an index out of range.
absl::StatusOr<std::string> WriteGlb(const std::string& assembly_name,
                                     const std::vector<GlbPart>& parts);

}  // namespace mortise::cad
