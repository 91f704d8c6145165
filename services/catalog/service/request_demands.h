// Checks what a request demands of an assembly, before that is tried.
#pragma once

#include <google/protobuf/repeated_field.h>

#include "absl/status/status.h"
#include "common/assembly/parametric_assembly.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

using Demands = google::protobuf::RepeatedPtrField<v1::MeasureDemand>;

// Fails with INVALID_ARGUMENT, "demands", if there are more than 100.
absl::Status CheckDemandCount(const Demands& demands);

// Fails with INVALID_ARGUMENT naming "demands[i].measure.element" of each demand on an element that
// there is not, with those that are called nearly so, and "demands[i].value" of each that is too
// far away. Nothing of demands that are too many.
absl::Status CheckDemands(const parametric::ParametricAssembly& assembly, const Demands& demands);

}  // namespace mortise::catalog
