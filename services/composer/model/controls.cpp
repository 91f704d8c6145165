#include "services/composer/model/controls.h"

#include <memory>
#include <utility>

#include "common/base/errors.h"
#include "services/composer/model/controlled_node.h"
#include "services/composer/model/node_drag.h"

namespace mortise::composer {
namespace {

using parametric::LinearForm;

constexpr double kNoRange = 1e-9;  // m

}  // namespace

absl::StatusOr<std::vector<Control>> ControlsOf(std::shared_ptr<const DragSpace> space,
                                                const Design& design, const std::string& node) {
  MORTISE_ASSIGN_OR_RETURN(const ControlledNode controlled,
                           ControlledNode::Find(std::move(space), design, node));
  std::vector<Control> controls;
  for (const ControlKind kind : {ControlKind::kCenter, ControlKind::kSize}) {
    for (const Axis axis : parametric::kAxes) {
      const LinearForm form = controlled.FormOf(kind, axis);
      if (!controlled.IsFree(form)) continue;
      Control control{kind, axis, form.At(controlled.now()), 0, 0};
      MORTISE_ASSIGN_OR_RETURN(control.minimum, controlled.End(form, -1));
      MORTISE_ASSIGN_OR_RETURN(control.maximum, controlled.End(form, 1));
      if (control.maximum - control.minimum > kNoRange) controls.push_back(control);
    }
  }
  return controls;
}

absl::StatusOr<std::vector<Control>> ControlsOf(const Design& design, const std::string& node) {
  return ControlsOf(std::make_shared<const DragSpace>(design.assembly), design, node);
}

absl::StatusOr<Design> Drag(const Design& design, const std::string& node, ControlKind kind,
                            Axis axis, double value) {
  MORTISE_ASSIGN_OR_RETURN(
      NodeDrag drag, NodeDrag::Begin(std::make_shared<const DragSpace>(design.assembly), design,
                                     node, kind, axis));
  return drag.To(value);
}

}  // namespace mortise::composer
