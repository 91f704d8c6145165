// Completes the reply about a template's design: adds its faults, or takes out what was not asked
// for.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"
#include "common/templates/template.h"
#include "mortise/v1/design.pb.h"

namespace mortise::catalog {

// Adds what is wrong with the design of `function` at q, if that is an assembly, in words: see
// parametric::ContactCheck, whose time it takes. Other kinds are as their authors made them.
// Fails as Template::AssemblyAt.
absl::Status AddFaults(const templates::Template& function, const Eigen::VectorXd& q,
                       v1::EvaluatedDesign& design);

// Takes out the vertices and triangles of parts that are no prisms.
void DropTriangles(v1::EvaluatedDesign& design);

}  // namespace mortise::catalog
