// Writes meshes with fields as VTU files (VTK XML unstructured grid), which ParaView opens.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

// One array of numbers: a column for each node or element.
struct VtuField {
  std::string name;        // with its unit: "displacement (m)"
  Eigen::MatrixXd values;  // 1 (scalar), 3 (vector) or 6 (symmetric tensor: xx yy zz xy yz xz) rows
};

// Returns the file's bytes: binary, little-endian, appended raw. Cell data always has "part", the
// index of the part. INVALID_ARGUMENT names the field whose size does not fit the mesh.
absl::StatusOr<std::string> WriteVtu(const TetrahedralMesh& mesh,
                                     const std::vector<VtuField>& point_fields,
                                     const std::vector<VtuField>& cell_fields = {});

// Does the same for a surface; its triangles are the cells, and there is no "part".
absl::StatusOr<std::string> WriteVtu(const SurfaceMesh& surface,
                                     const std::vector<VtuField>& point_fields,
                                     const std::vector<VtuField>& cell_fields = {});

}  // namespace mortise::mesh
