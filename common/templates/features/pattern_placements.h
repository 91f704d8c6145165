// Finds where the copies of a pattern stand against the feature itself. Private to this folder: it
// brings Open CASCADE's headers.
#pragma once

#include <gp_Trsf.hxx>
#include <vector>

#include "absl/status/statusor.h"
#include "common/templates/features/feature_numbers.h"

namespace mortise::cad {

// Returns one rigid motion (mm) for each instance from 1 on. INVALID_ARGUMENT naming the field of a
// step, angle or axis without length, or of more than kMaxInstances.
absl::StatusOr<std::vector<gp_Trsf>> PlacementsOf(const LinearPattern& pattern,
                                                  const Numbers& numbers);
absl::StatusOr<std::vector<gp_Trsf>> PlacementsOf(const CircularPattern& pattern,
                                                  const Numbers& numbers);

}  // namespace mortise::cad
