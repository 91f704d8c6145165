#include "services/composer/service/drag_cache.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::composer {

OpenDrag::OpenDrag(OpenModel model, const DraggedControl& control, NodeDrag drag)
    : model_(std::move(model)), component_(control.component), drag_(std::move(drag)) {
  stored_ = ShownParts(model_, component_, drag_.beginning());
  value_ = drag_.ValueIn(drag_.beginning());
}

absl::StatusOr<OpenDrag::Dragged> OpenDrag::To(double value) {
  const std::lock_guard lock(mutex_);
  if (last_value_ == value) return last_;
  MORTISE_ASSIGN_OR_RETURN(const Design there, drag_.To(value));
  last_ = {drag_.ValueIn(there), ShownParts(model_, component_, there)};
  last_value_ = value;
  return last_;
}

std::size_t OpenDrag::MemoryUse() const {
  constexpr std::size_t kPart = 512;  // bytes of a message
  return sizeof(*this) + drag_.MemoryUse() + 3 * stored_.size() * kPart;
}

DragCache::DragCache(std::size_t capacity)
    : spaces_(capacity / 2, Oversize::kAlone), drags_(capacity / 2, Oversize::kAlone) {}

absl::StatusOr<std::shared_ptr<const DragSpace>> DragCache::SpaceOf(const OpenDesign& design) {
  using Made = SingleFlightCache<std::shared_ptr<const DragSpace>>::Made;
  return spaces_.Get(absl::StrCat(design.drawing, "/", design.group),
                     [&]() -> absl::StatusOr<Made> {
                       auto space = std::make_shared<const DragSpace>(design.design.assembly);
                       const std::size_t bytes = space->MemoryUse();
                       return Made{std::move(space), bytes};
                     });
}

absl::StatusOr<NodeDrag> DragCache::Begin(const OpenDesign& design, const DraggedControl& control) {
  MORTISE_ASSIGN_OR_RETURN(const ControlName name, ParseControl(control.control));
  MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const DragSpace> space, SpaceOf(design));
  return NodeDrag::Begin(std::move(space), design.design, control.node, name.kind, name.axis);
}

absl::StatusOr<std::shared_ptr<OpenDrag>> DragCache::DragOf(
    const std::string& digest, const DraggedControl& control,
    const std::function<absl::StatusOr<OpenModel>()>& open) {
  using Made = SingleFlightCache<std::shared_ptr<OpenDrag>>::Made;
  const std::string key =
      absl::StrCat(digest, "/", control.component, "/", control.control, "/", control.node);
  return drags_.Get(key, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(OpenModel model, open());
    MORTISE_ASSIGN_OR_RETURN(const OpenDesign* const design, FindDesign(model, control.component));
    MORTISE_ASSIGN_OR_RETURN(NodeDrag begun, Begin(*design, control));
    auto drag = std::make_shared<OpenDrag>(std::move(model), control, std::move(begun));
    const std::size_t bytes = drag->MemoryUse();
    return Made{std::move(drag), bytes};
  });
}

}  // namespace mortise::composer
