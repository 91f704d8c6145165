// Assemblies at parameters as STEP files.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/parametric/evaluated_design.h"
#include "common/parametric/parametric_assembly.h"

namespace mortise::catalog {

// STEP AP242 of `design`, which is `assembly` at q: its groups as sub-assemblies, its parts as
// occurrences under their names, where they are; what is round is a cylinder. Parts of one item,
// size and colour are of one product, as they would be drawn. `colors`: one a part, linear red,
// green, blue.
absl::StatusOr<std::string> ExportAssemblyStep(const parametric::ParametricAssembly& assembly,
                                               const Eigen::VectorXd& q,
                                               const parametric::EvaluatedDesign& design,
                                               const std::vector<Eigen::Vector3d>& colors,
                                               const std::string& name);

}  // namespace mortise::catalog
