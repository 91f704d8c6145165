#include "common/assembly/relations/principal_patterns.h"

#include "common/assembly/model/pattern.h"

namespace mortise::parametric {
namespace {

// Parts that grew with their spacing would not stay with what repeats beside them.
void KeepSizesAlong(int axis, double tolerance, Element& element) {
  const auto index = static_cast<std::size_t>(axis);
  if (!element.pattern->resizable[index]) return;
  element.pattern->resizable[index] = false;
  element.limits[index] = LengthsOf(*element.pattern, axis, element.box.size()[axis], tolerance);
}

}  // namespace

void FollowPrincipalPatterns(std::vector<Element>& elements, const Contacts& contacts,
                             double tolerance) {
  for (const auto& [a, b] : contacts) {
    Element& first = elements[static_cast<std::size_t>(a)];
    Element& second = elements[static_cast<std::size_t>(b)];
    if (!first.pattern || !second.pattern) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!CommonDirection(*first.pattern, *second.pattern, axis, tolerance)) continue;
      KeepSizesAlong(axis, tolerance, first);
      KeepSizesAlong(axis, tolerance, second);
    }
  }
  const auto follow = [&](Element& follower, const Element& principal) {
    if (!follower.connecting || principal.connecting) return;
    for (int axis = 0; axis < 3; ++axis) {
      const auto common = CommonDirection(*follower.pattern, *principal.pattern, axis, tolerance);
      if (!common) continue;
      follower.pattern->directions[static_cast<std::size_t>(common->first)].principal_size =
          principal.pattern->part_size[axis];
    }
  };
  for (const auto& [a, b] : contacts) {
    Element& first = elements[static_cast<std::size_t>(a)];
    Element& second = elements[static_cast<std::size_t>(b)];
    if (!first.pattern || !second.pattern) continue;
    follow(first, second);
    follow(second, first);
  }
}

}  // namespace mortise::parametric
