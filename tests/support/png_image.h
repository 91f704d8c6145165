// Reads the pictures that programs make, so that tests can look at their pixels.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/render/image.h"

namespace mortise::testing {

// Returns the image of a PNG file (any colour type, alpha over white). INVALID_ARGUMENT if it is
// broken.
absl::StatusOr<render::Image> DecodePng(const std::string& png);

}  // namespace mortise::testing
