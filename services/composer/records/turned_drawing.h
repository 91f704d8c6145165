// Drawings turned by right angles.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "services/composer/records/drawing.h"

namespace mortise::composer {

// Returns the drawing turned about the origin (quarter_turn.h), under the same name: parts with the
// axes of their items, so that what is cut and bought stays the same; prominent planes, joints and
// shapes. A part that looks otherwise when it is turned, than it does by its item's shape or as its
// own is drawn, has a shape of its own, stored with the drawing under its digest. Without a turn it
// is the drawing itself. INVALID_ARGUMENT as ReadAssembly and cad::ShapeDrawnTurned.
absl::StatusOr<Drawing> TurnedDrawing(const Drawing& drawing, const Eigen::Matrix3d& turn);

}  // namespace mortise::composer
