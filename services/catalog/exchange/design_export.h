// Designs as files that other programs open.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/design/evaluated_design.h"
#include "services/catalog/exchange/design_identity.h"

namespace mortise::catalog {

// Files of triangles.
enum class MeshFormat { kGlb, kObj, kStl };

// STEP AP242: the B-rep of every part under its name, in an assembly named `assembly_name`.
// `solids`: one a part of the design, in its order. Products have the ids and revisions of
// `identity` (ProductIdentity), and the file has the time of its revision, so that it is always the
// same.
absl::StatusOr<std::string> ExportStep(const parametric::EvaluatedDesign& design,
                                       const std::vector<cad::Solid>& solids,
                                       const std::string& assembly_name,
                                       const DesignIdentity& identity);

// Returns what each part looks like: its own colour, or that of its material; linear red, green,
// blue.
std::vector<Eigen::Vector3d> PartColors(const parametric::EvaluatedDesign& design);

// Returns the triangles of every part: binary glTF in metres, a named and coloured node a part;
// Wavefront OBJ in metres, a named object a part; or binary STL in millimetres, all parts in one.
// `motions`: how each part is moved first, one a part, or none at all.
absl::StatusOr<std::string> ExportMesh(const parametric::EvaluatedDesign& design,
                                       const std::vector<Eigen::Isometry3d>& motions,
                                       MeshFormat format, const std::string& assembly_name);

}  // namespace mortise::catalog
