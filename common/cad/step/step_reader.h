// Reads STEP assemblies (AP203, AP214, AP242): the tree, and every solid in it, measured.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

inline constexpr std::size_t kMaxStepBytes = std::size_t{64} << 20;

// Called with what is wrong with entities of the file, "#12: …", before their shapes are made.
using StepFaultsSeen = std::function<void(const std::vector<std::string>&)>;

// Returns the assembly in `bytes`, in metres whatever the file's unit. Every solid is a part, also
// where a product has several; several roots stand in one. Names that the file has more than once
// are counted (DistinctNames); a part is called as its occurrence is, or else as its product.
//
// INVALID_ARGUMENT, "step": not STEP, cut off, entities that are referred to and not there
// (step_references.h), nothing solid in it, parts in other files,
// products that contain themselves, with the entities at fault where the file has such.
// RESOURCE_EXHAUSTED: more than kMaxStepBytes, or more than 2,000 parts.
//
// The kernel may crash over a damaged file, and the process with it; step_isolation.h does not.
absl::StatusOr<StepAssembly> ReadStep(std::string_view bytes, const StepFaultsSeen& seen = {});

}  // namespace mortise::cad
