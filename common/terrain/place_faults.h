// What is told of places where a height field is not known. Private to this folder.
#pragma once

#include "absl/status/status.h"
#include "common/terrain/height_field.h"

namespace mortise::terrain {

// Returns OUT_OF_RANGE for a point or rectangle that does not lie in `known`.
absl::Status NotKnownAt(const Rectangle& known, double x, double y);
absl::Status NotKnownUnder(const Rectangle& known, const Rectangle& rectangle);

// Returns OUT_OF_RANGE for a place amid what is known.
absl::Status HoleAt(double x, double y);

}  // namespace mortise::terrain
