// What is found out about a drawn assembly by looking at its surfaces and by trying designs of it:
// which parts touch, which patterns are no patterns, and what is to be held besides. Finding it
// takes most of the time of a parametrisation, and takes little room. Whoever keeps it beside the
// assembly parametrises that again at once, to the same result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "common/assembly/model/pattern.h"
#include "common/assembly/trial/design_trial.h"
#include "common/assembly/trial/drawn_contacts.h"

namespace mortise::parametric {

// Grows whenever the searches come to other outcomes for some assembly: what an earlier version
// came to is then found anew.
inline constexpr int kSearchVersion = 1;

// Parts are told by their indices in the assembly.
struct SearchOutcome {
  TouchingParts touching;
  PatternLosses pattern_losses;
  RepairPlan repair_plan;
};

// Whether an outcome names only parts that there are, of so many.
bool NamesPartsOf(const SearchOutcome& outcome, std::size_t parts);

// Is told what is being done, for people ("looking for contacts"), how much of it is done, and of
// how much; 0 of 0 where that is not counted.
using SearchProgress =
    std::function<void(const char* stage, std::int64_t done, std::int64_t total)>;

}  // namespace mortise::parametric
