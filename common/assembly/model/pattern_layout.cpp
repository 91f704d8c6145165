// How a pattern fills a box of another size than the drawn one.
#include <algorithm>
#include <cmath>

#include "common/assembly/model/pattern.h"

namespace mortise::parametric {
namespace {

constexpr int kMost = 100'000;      // parts along a direction
constexpr double kRounding = 1e-9;  // of lengths that are computed

bool LeadsAlong(const PatternDirection& direction, int axis) {
  return direction.count > 1 && std::abs(direction.spacing[axis]) > 1e-9 * direction.spacing.norm();
}

struct Laid {
  Eigen::Vector3d spacing = Eigen::Vector3d::Zero();
  Eigen::Vector3d part_size;  // changed along the direction only
};

// `count` parts along one direction of the pattern, between the ends of a box of this size.
Laid Lay(const Pattern& pattern, const PatternDirection& direction, int count,
         const Eigen::Vector3d& box_size) {
  Laid laid;
  laid.part_size = pattern.part_size;
  for (int axis = 0; axis < 3; ++axis) {
    if (!LeadsAlong(direction, axis)) continue;
    const double original = std::abs(direction.spacing[axis]);
    const double part = pattern.part_size[axis];
    const double sign = direction.spacing[axis] < 0 ? -1 : 1;
    if (pattern.resizable[static_cast<std::size_t>(axis)]) {
      // (count - 1) · spacing + part · spacing / original fills the box.
      const double spacing = box_size[axis] / (count - 1 + part / original);
      laid.spacing[axis] = sign * spacing;
      laid.part_size[axis] = part * spacing / original;
    } else {
      laid.spacing[axis] = sign * (box_size[axis] - part) / (count - 1);
    }
  }
  return laid;
}

// Whether neighbours, of the pattern or of the principal one that it follows, do not stay clear of
// each other where they were clear in the original.
bool Intersects(const Pattern& pattern, const PatternDirection& direction, const Laid& laid) {
  if (direction.principal_size > 0) {
    const double clear_from = direction.principal_size - 1e-9 * (1 + direction.principal_size);
    return direction.spacing.norm() >= clear_from && laid.spacing.norm() < clear_from;
  }
  bool clear = false;
  bool was_clear = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-9 * (1 + pattern.part_size.norm());
    clear |= std::abs(laid.spacing[axis]) >= laid.part_size[axis] - slack;
    was_clear |= std::abs(direction.spacing[axis]) >= pattern.part_size[axis] - slack;
  }
  return was_clear && !clear;
}

// 1 if parts are larger than they may be, -1 if they are smaller, 0 if they are neither.
int BeyondLimits(const Pattern& pattern, const PatternDirection& direction, const Laid& laid) {
  int beyond = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::size_t>(axis);
    if (!LeadsAlong(direction, axis) || !pattern.resizable[index]) continue;
    const SizeLimits& limits = pattern.part_limits[index];
    if (laid.part_size[axis] > limits.maximum * (1 + kRounding)) return 1;
    if (laid.part_size[axis] < limits.minimum * (1 - kRounding)) beyond = -1;
  }
  return beyond;
}

int CountFor(const Pattern& pattern, const PatternDirection& direction,
             const Eigen::Vector3d& box_size) {
  const double original = direction.spacing.norm();
  const auto spacing = [&](int count) {
    return Lay(pattern, direction, count, box_size).spacing.norm();
  };
  // The spacing falls as the count grows: the first that is not above the original.
  int low = 2;
  int high = 2;
  while (spacing(high) > original * (1 + 1e-9) && high < kMost) high *= 2;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (spacing(middle) > original * (1 + 1e-9)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  int count = low;
  if ((!pattern.connecting || direction.principal_size > 0) && count > 2 &&
      spacing(count - 1) - original <= original - spacing(count)) {
    --count;
  }
  const auto beyond = [&](int parts) {
    return BeyondLimits(pattern, direction, Lay(pattern, direction, parts, box_size));
  };
  while (count < kMost && beyond(count) > 0) ++count;
  while (count > 2 && beyond(count) < 0 && beyond(count - 1) <= 0) --count;
  while (count > 2 && Intersects(pattern, direction, Lay(pattern, direction, count, box_size))) {
    --count;
  }
  return count;
}

}  // namespace

bool LeadsAlong(const Pattern& pattern, int axis) {
  return LeadsAlong(pattern.directions[0], axis) || LeadsAlong(pattern.directions[1], axis);
}

SizeLimits LengthsOf(const Pattern& pattern, int axis, double drawn, double tolerance) {
  const PatternDirection& direction =
      LeadsAlong(pattern.directions[0], axis) ? pattern.directions[0] : pattern.directions[1];
  const auto index = static_cast<std::size_t>(axis);
  const double spacing = std::abs(direction.spacing[axis]);
  const double part = pattern.part_size[axis];
  SizeLimits lengths{drawn / 2, 2 * drawn};
  if (!pattern.resizable[index]) {
    // Two parts side by side, or at their drawn spacing where they overlap in the drawing.
    const double room = std::min(spacing, part) + part;
    lengths.minimum = std::min(std::max(lengths.minimum, room), drawn);
    const bool touching = std::abs(direction.spacing.norm() - part) <= tolerance;
    return touching ? SizeLimits{drawn, drawn} : lengths;
  }
  // `count` parts of size s at spacings that scale with it are s · (count - 1) · spacing / part + s
  // long.
  const auto length = [&](int count, double size) {
    return size * ((count - 1) * spacing / part + 1);
  };
  const SizeLimits& sizes = pattern.part_limits[index];
  int fewest = direction.count, most = direction.count;
  while (fewest > 2 && length(fewest, sizes.minimum) <= length(fewest - 1, sizes.maximum)) --fewest;
  while (most < 2 * direction.count + 1 &&
         length(most + 1, sizes.minimum) <= length(most, sizes.maximum)) {
    ++most;
  }
  lengths.minimum = std::min(std::max(lengths.minimum, length(fewest, sizes.minimum)), drawn);
  lengths.maximum = std::max(std::min(lengths.maximum, length(most, sizes.maximum)), drawn);
  return lengths;
}

Eigen::Vector3d PatternLayout::CenterOf(int index) const {
  return first_center + (index % directions[0].count) * directions[0].spacing +
         (index / directions[0].count) * directions[1].spacing;
}

bool RepeatAlike(const PatternDirection& a, const PatternDirection& b, double tolerance) {
  return a.count > 1 && a.count == b.count && (a.spacing - b.spacing).norm() <= tolerance;
}

std::optional<std::pair<int, int>> CommonDirection(const Pattern& a, const Pattern& b, int axis,
                                                   double tolerance) {
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const PatternDirection& of_a = a.directions[static_cast<std::size_t>(i)];
      const PatternDirection& of_b = b.directions[static_cast<std::size_t>(j)];
      const bool along_axis = std::abs(of_a.spacing[axis]) >= of_a.spacing.norm() - tolerance;
      if (along_axis && RepeatAlike(of_a, of_b, tolerance)) return std::pair(i, j);
    }
  }
  return std::nullopt;
}

PatternLayout LayOut(const Pattern& pattern, const BoundingBox& box) {
  PatternLayout layout;
  layout.part_size = pattern.part_size;
  for (int axis = 0; axis < 3; ++axis) {
    if (!LeadsAlong(pattern, axis)) layout.part_size[axis] = box.size()[axis];
  }
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();  // from the first part to the last
  for (std::size_t i = 0; i < 2; ++i) {
    const PatternDirection& direction = pattern.directions[i];
    if (direction.count < 2) continue;
    const int count = CountFor(pattern, direction, box.size());
    const Laid laid = Lay(pattern, direction, count, box.size());
    layout.directions[i] = {count, laid.spacing};
    reach += (count - 1) * laid.spacing;
    for (int axis = 0; axis < 3; ++axis) {
      if (LeadsAlong(direction, axis)) layout.part_size[axis] = laid.part_size[axis];
    }
  }
  layout.first_center = box.center() - reach / 2;
  return layout;
}

}  // namespace mortise::parametric
