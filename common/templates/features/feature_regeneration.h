// Makes a list of features, one after the other, with numbers that have been found usable. Private
// to this folder; feature_model.h is the door.
#pragma once

#include "absl/status/statusor.h"
#include "common/templates/features/feature_model.h"

namespace mortise::cad {

// Makes all features. INVALID_ARGUMENT naming the place of a feature that cannot be made. Features
// that cut or unite in a row are done together, which is several times as fast, but leaves open
// which of them is at fault. `one_by_one` tells exactly, and runs the kernel's check after each.
absl::StatusOr<RegeneratedModel> RegenerateFeatures(const CadTemplate& definition,
                                                    const Numbers& numbers, bool one_by_one);

}  // namespace mortise::cad
