// The controls on the bounding box of a node, and what becomes of the design when one is dragged
// (thesis §5.3).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/composer/model/design.h"
#include "services/composer/model/drag_space.h"

namespace mortise::composer {

enum class ControlKind { kCenter, kSize };

// One of the six: where the middle of the node's box is along an axis, or how large it is.
struct Control {
  ControlKind kind = ControlKind::kSize;
  Axis axis = Axis::kX;
  double value = 0;    // m, now; places are in the model's coordinates
  double minimum = 0;  // m, what it can be dragged to
  double maximum = 0;
};

// Returns the controls of a node that can be dragged: "" is the whole, otherwise a group, an
// element or the parts of a row, as SubTreeOf says. The box of a group is that of its parts, so its
// controls are those of the elements that bound it as they are now; a part of a row is controlled
// with its row. A control is left out where the
// feasible set determines it (numerically: no direction of the set changes it by more than a
// billionth), or its ends are no more than 1 nm apart.
//
// The model stands on its floor, and the middle of its box stays along x and y: what is dragged
// moves against that. INVALID_ARGUMENT, "node", where nothing is called so. It takes linear
// programmes.
absl::StatusOr<std::vector<Control>> ControlsOf(const Design& design, const std::string& node);

// The same, with what dragging takes of the design's structure at hand.
absl::StatusOr<std::vector<Control>> ControlsOf(std::shared_ptr<const DragSpace> space,
                                                const Design& design, const std::string& node);

// Returns the design nearest to this one in which the control has the value, m, or comes as near to
// it as it can: (5.1) in the limit α → 0. Connecting parts go where their connections want them.
// Relationships hold to 1e-9 m. For many values see node_drag.h. INVALID_ARGUMENT, "node", as
// above; "control" where it is not among the node's controls; "value" if it is not finite.
absl::StatusOr<Design> Drag(const Design& design, const std::string& node, ControlKind kind,
                            Axis axis, double value);

}  // namespace mortise::composer
