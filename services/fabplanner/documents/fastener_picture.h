// Draws a fastener, lying, for the list of those that a step takes.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// Return the PNG, 240 × 90 pixels.
absl::StatusOr<std::string> FastenerPicture(const Part& part);
absl::StatusOr<std::string> FastenerPicture(const Peg& peg);

}  // namespace mortise::fabplanner
