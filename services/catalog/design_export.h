// Designs as files that other programs open.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/parametric/evaluated_design.h"

namespace mortise::catalog {

// STEP AP242: the B-rep of every part under its name, in an assembly named `assembly_name`.
// `solids`: one a part of the design, in its order.
absl::StatusOr<std::string> ExportStep(const parametric::EvaluatedDesign& design,
                                       const std::vector<cad::Solid>& solids,
                                       const std::string& assembly_name);

// What each part looks like by its material: linear red, green, blue.
std::vector<Eigen::Vector3d> PartColors(const parametric::EvaluatedDesign& design);

// Binary glTF: the triangles of every part.
absl::StatusOr<std::string> ExportGlb(const parametric::EvaluatedDesign& design,
                                      const std::string& assembly_name);

}  // namespace mortise::catalog
