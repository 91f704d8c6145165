// Units that coordinates of meshes are in.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace mortise::mesh {

// Returns how many metres one of the unit is: of "m", "cm", "mm", "um", "in" and "ft".
// INVALID_ARGUMENT naming `field` for another one, and for none.
absl::StatusOr<double> MetresOf(const std::string& length_unit, const std::string& field);

}  // namespace mortise::mesh
