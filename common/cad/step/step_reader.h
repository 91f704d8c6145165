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

// A function that is called with what is wrong with entities of the file, "#12: …", before their
// shapes are made.
using StepFaultsSeen = std::function<void(const std::vector<std::string>&)>;

// A function that is told how many solids have been read, measured and drawn, and how many there
// are.
using StepProgress = std::function<void(std::size_t done, std::size_t total)>;

// Reads the assembly in `bytes`, in metres whatever the file's unit. Every solid is a part, also
// where a product has several; several roots stand in one. Names that the file has more than once
// are counted (DistinctNames); a part is called as its occurrence is, or else as its product.
//
// INVALID_ARGUMENT, "step", for bytes that are not STEP or cut off, for entities that are referred
// to and not there (step_references.h), if there is nothing solid in the file, and for parts in
// other files and products that contain themselves, with the entities at fault if there are any.
// RESOURCE_EXHAUSTED for more than kMaxStepBytes, or more than 2,000 parts.
//
// The kernel may crash over a damaged file, and the process with it. A process that reads by
// step_isolation.h outlives that.
absl::StatusOr<StepAssembly> ReadStep(std::string_view bytes, const StepFaultsSeen& seen = {},
                                      const StepProgress& progress = {});

}  // namespace mortise::cad
