// Reads the boundary conditions of a design: what they ask for, what they lack, and as supports,
// loads and heat of the model that is analysed.
#pragma once

#include <cstddef>

#include "absl/status/status.h"
#include "common/design/evaluated_design.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// Whether heat is asked for.
bool HasHeat(const parametric::EvaluatedDesign& design);

// Whether anything causes stress: loads, supports that are moved, or heat with a reference
// temperature.
bool IsLoaded(const parametric::EvaluatedDesign& design);

// Returns how many load cases there are; one where none has a name.
std::size_t CountLoadCases(const parametric::EvaluatedDesign& design);

// Fails with FAILED_PRECONDITION, NO_SUPPORTS, saying what to add, for a design that nothing holds.
absl::Status CheckSupported(const parametric::EvaluatedDesign& design);

// Fails with FAILED_PRECONDITION, NO_LOADS, saying what to add, for a design that nothing loads.
absl::Status CheckLoaded(const parametric::EvaluatedDesign& design);

// Fails with FAILED_PRECONDITION, NO_HEAT or FREE_TEMPERATURE, saying what to add, for a design
// that nothing heats, or whose heat leaves every temperature open.
absl::Status CheckHeated(const parametric::EvaluatedDesign& design);

// Adds the conditions of `bearing`, a design of the model's parts in their order: supports, loads
// of each load case, heat (without its materials) and the reference temperature. INVALID_ARGUMENT
// naming the condition whose part is not there.
absl::Status AddConditions(const parametric::EvaluatedDesign& bearing, DesignModel& model);

}  // namespace mortise::simulator
