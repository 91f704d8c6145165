// Controls as messages name them (thesis §5.3).
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/model/controls.h"

namespace mortise::composer {

// Which of the six controls of a node is meant.
struct ControlName {
  ControlKind kind = ControlKind::kSize;
  Axis axis = Axis::kX;
};

// "width", "depth", "height": the sizes along x, y and z; "x", "y", "z": where the middle is.
// INVALID_ARGUMENT, "control", for any other.
absl::StatusOr<ControlName> ParseControl(const std::string& name);

v1::NodeControl ToProto(const Control& control);

}  // namespace mortise::composer
