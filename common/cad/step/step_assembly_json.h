// What was read of a STEP file as JSON text, for the way from one process to another: all but the
// products' solids.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

std::string ToJson(const StepAssembly& assembly);

// INTERNAL if `text` is not what ToJson gives.
absl::StatusOr<StepAssembly> StepAssemblyFromJson(std::string_view text);

}  // namespace mortise::cad
