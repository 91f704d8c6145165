#include "common/parametric/easily_lost.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/errors.h"
#include "common/parametric/pattern_contact.h"

namespace mortise::parametric {
namespace {

bool RepeatsWith(const PatternDirection& direction, const Element& other, double tolerance) {
  if (!other.pattern) return false;
  return std::any_of(
      other.pattern->directions.begin(), other.pattern->directions.end(),
      [&](const PatternDirection& theirs) { return RepeatAlike(direction, theirs, tolerance); });
}

// Where the box of an element begins and ends along an axis.
LinearForm MinimumOf(int element, Axis axis) {
  return Combine(1, LinearForm::Variable(CenterVariable(element, axis)), -0.5,
                 LinearForm::Variable(SizeVariable(element, axis)));
}
LinearForm MaximumOf(int element, Axis axis) {
  return Combine(1, LinearForm::Variable(CenterVariable(element, axis)), 0.5,
                 LinearForm::Variable(SizeVariable(element, axis)));
}

// Whether `other` has the first part of the pattern beside it along the axis in every feasible
// design, or the last one.
absl::StatusOr<bool> StaysAtAnEnd(const std::vector<Element>& elements, int row, int other,
                                  Axis axis, const FeasibleSet& feasible_set, double tolerance) {
  const auto index = static_cast<std::size_t>(axis);
  const Pattern& pattern = *elements[static_cast<std::size_t>(row)].pattern;
  const double length = pattern.resizable[index]
                            ? pattern.part_limits[index].minimum
                            : pattern.part_size[static_cast<Eigen::Index>(axis)];
  const LinearForm before_first = Combine(1, MinimumOf(row, axis), -1, MaximumOf(other, axis));
  const LinearForm into_row = Combine(1, MinimumOf(other, axis), -1, MinimumOf(row, axis));
  const LinearForm behind_last = Combine(1, MinimumOf(other, axis), -1, MaximumOf(row, axis));
  const LinearForm from_end = Combine(1, MaximumOf(row, axis), -1, MaximumOf(other, axis));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Range> ranges,
                           feasible_set.RangesOf({before_first, into_row, behind_last, from_end}));
  const bool at_first = ranges[0].maximum <= tolerance && ranges[1].maximum <= length + tolerance;
  const bool at_last = ranges[2].maximum <= tolerance && ranges[3].maximum <= length + tolerance;
  return at_first || at_last;
}

// The widest gap between two parts of a pattern, at any length of its box along the axis within the
// range: gaps grow by no more than the box does until there are more parts, so a grid of lengths
// misses no more than its step.
double WidestGap(const Element& row, Axis axis, const Range& lengths) {
  constexpr int kSteps = 1000;
  const auto index = static_cast<Eigen::Index>(axis);
  const double step = (lengths.maximum - lengths.minimum) / kSteps;
  double widest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    BoundingBox box = row.box;
    box.maximum[index] = box.minimum[index] + lengths.minimum + i * step;
    const PatternLayout layout = LayOut(*row.pattern, box);
    for (const PatternDirection& direction : layout.directions) {
      const double gap = std::abs(direction.spacing[index]) - layout.part_size[index];
      if (direction.count > 1) widest = std::max(widest, gap);
    }
  }
  return widest + step;
}

// Whether `other` is longer than any gap of the pattern in every feasible design.
absl::StatusOr<bool> BridgesGaps(const std::vector<Element>& elements, int row, int other,
                                 Axis axis, const FeasibleSet& feasible_set) {
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<Range> sizes,
      feasible_set.RangesOf({LinearForm::Variable(SizeVariable(row, axis)),
                             LinearForm::Variable(SizeVariable(other, axis))}));
  return sizes[1].minimum > WidestGap(elements[static_cast<std::size_t>(row)], axis, sizes[0]);
}

// The axis that a direction follows; nothing of one that slopes.
std::optional<Axis> AxisOf(const PatternDirection& direction, double tolerance) {
  for (const Axis axis : kAxes) {
    const double along = std::abs(direction.spacing[static_cast<Eigen::Index>(axis)]);
    if (along >= direction.spacing.norm() - tolerance) return axis;
  }
  return std::nullopt;
}

}  // namespace

absl::StatusOr<std::set<int>> FindEasilyLost(const Assembly& assembly,
                                             const std::vector<Element>& elements,
                                             const FeasibleSet& feasible_set, double tolerance) {
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  std::set<int> lost;
  for (std::size_t row = 0; row < elements.size(); ++row) {
    if (!elements[row].pattern) continue;
    const Pattern& pattern = *elements[row].pattern;
    for (const PartialContact& contact :
         FindPartialContacts(assembly, pattern.directions, elements[row].parts, tolerance)) {
      const int other = element_of[static_cast<std::size_t>(contact.part)];
      const Element& touching = elements[static_cast<std::size_t>(other)];
      const PatternDirection& direction =
          pattern.directions[static_cast<std::size_t>(contact.direction)];
      if (RepeatsWith(direction, touching, tolerance)) continue;
      if (contact.stands_between) {
        lost.insert(contact.part);
        continue;
      }
      const std::optional<Axis> axis = AxisOf(direction, tolerance);
      const bool moves_by_itself =
          !axis || (touching.pattern && LeadsAlong(*touching.pattern, static_cast<int>(*axis)));
      if (!moves_by_itself) {
        MORTISE_ASSIGN_OR_RETURN(
            const bool stays,
            StaysAtAnEnd(elements, static_cast<int>(row), other, *axis, feasible_set, tolerance));
        if (stays) continue;
        MORTISE_ASSIGN_OR_RETURN(const bool bridges, BridgesGaps(elements, static_cast<int>(row),
                                                                 other, *axis, feasible_set));
        if (bridges) continue;
      }
      lost.insert(contact.part);
    }
  }
  return lost;
}

}  // namespace mortise::parametric
