// Makes a list of features, one after the other, with numbers that have been found usable. Private
// to this folder; feature_model.h is the door.
#pragma once

#include "absl/status/statusor.h"
#include "common/cad/feature_model.h"

namespace mortise::cad {

// INVALID_ARGUMENT naming the place of the first feature that cannot be made. With `check_each` the
// kernel's check runs after every feature, which tells the one that makes the solid invalid.
absl::StatusOr<RegeneratedModel> RegenerateFeatures(const CadTemplate& definition,
                                                    const Numbers& numbers, bool check_each);

// The status of a solid that fails the kernel's check at the end has this reason.
inline constexpr char kInvalidSolid[] = "SOLID_INVALID";

}  // namespace mortise::cad
