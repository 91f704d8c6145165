// Assemblies at parameters, in any rest pose, as files.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/parametric_assembly.h"
#include "common/design/evaluated_design.h"
#include "services/catalog/exchange/design_export.h"

namespace mortise::catalog {

// An assembly at q as a design, and the pose in which it is written.
struct PosedAssembly {
  const parametric::ParametricAssembly& assembly;
  const Eigen::VectorXd& q;
  const parametric::EvaluatedDesign& design;  // parametric::DesignAt of the two
  std::string rest_pose;                      // "joint: pose"; empty for the drawn one
  DesignIdentity identity = {};               // for STEP
};

// Fails with INVALID_ARGUMENT, "rest_pose", with those that there are, for one that there is not.
absl::Status CheckRestPose(const parametric::Assembly& assembly, const std::string& rest_pose);

// STEP AP242: the groups as sub-assemblies, the parts as occurrences under their names, where they
// are, in their colours. Parts with a shape are that, stretched exactly; what else is round is a
// cylinder, and the rest are boxes. Parts of one item, shape, size and colour are of one product,
// as they would be drawn, also where right angles turn them. A product is called as its item where
// that is bought as it is, else as its first part; products that would be called alike are
// numbered. They have the ids and revisions of `posed.identity`
// (ProductIdentity), and the file has the time of its revision. The whole is called by `name`, as
// importing gives it back as title; line breaks in it become blanks. INVALID_ARGUMENT, "rest_pose",
// for one that there is not, and naming the part that cannot be made.
absl::StatusOr<std::string> ExportAssemblyStep(const PosedAssembly& posed, const std::string& name);

// Returns the triangles of the parts. INVALID_ARGUMENT, "rest_pose".
absl::StatusOr<std::string> ExportAssemblyMesh(const PosedAssembly& posed, MeshFormat format,
                                               const std::string& name);

}  // namespace mortise::catalog
