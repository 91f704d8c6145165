// Writes as JSON text what was read of a STEP file, all but the products' solids, for the way from
// one process to another.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

std::string ToJson(const StepAssembly& assembly);

// Reads what ToJson wrote. INTERNAL if `text` is not such.
absl::StatusOr<StepAssembly> StepAssemblyFromJson(std::string_view text);

}  // namespace mortise::cad
