// What people ask of an assembly, before it is tried.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "common/parametric/parametric_assembly.h"

namespace mortise::catalog {

// INVALID_ARGUMENT naming "demands[i].measure.element" of each demand on an element that there is
// not, with those that are called nearly so.
absl::Status CheckElements(const parametric::ParametricAssembly& assembly,
                           const std::vector<parametric::MeasureDemand>& demands);

}  // namespace mortise::catalog
