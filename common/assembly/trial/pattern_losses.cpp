#include "common/assembly/trial/pattern_losses.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/assembly/model/pattern_contact.h"
#include "common/base/errors.h"

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

// Whether a pattern has parts as far apart as along a direction of another, however many.
bool GoesAlong(const PatternDirection& direction, const Element& other, double tolerance) {
  if (!other.pattern) return false;
  return std::any_of(other.pattern->directions.begin(), other.pattern->directions.end(),
                     [&](const PatternDirection& theirs) {
                       PatternDirection as_long = theirs;
                       as_long.count = direction.count;
                       return theirs.count > 1 && RepeatAlike(direction, as_long, tolerance);
                     });
}

class LossSearch {
 public:
  LossSearch(const Assembly& assembly, const std::vector<Element>& elements,
             const FeasibleSet& feasible_set, double tolerance)
      : elements_(elements),
        feasible_set_(feasible_set),
        tolerance_(tolerance),
        element_of_(ElementsOfParts(assembly, elements)),
        contacts_(elements.size()) {
    for (std::size_t row = 0; row < elements.size(); ++row) {
      if (!elements[row].pattern) continue;
      contacts_[row] = FindPartialContacts(assembly, elements[row].pattern->directions,
                                           elements[row].parts, tolerance);
    }
  }

  absl::StatusOr<PatternLosses> Find() {
    for (std::size_t row = 0; row < elements_.size(); ++row) {
      for (const PartialContact& contact : contacts_[row]) {
        MORTISE_RETURN_IF_ERROR(Look(static_cast<int>(row), contact));
      }
    }
    return std::move(lost_);
  }

 private:
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }
  int ElementOf(int part) const { return element_of_[static_cast<std::size_t>(part)]; }
  const PatternDirection& DirectionOf(int row, const PartialContact& contact) const {
    return At(row).pattern->directions[static_cast<std::size_t>(contact.direction)];
  }

  void Lose(int row, int part) {
    for (const int own : At(row).parts) lost_.emplace(own, part);
  }

  absl::Status Look(int row, const PartialContact& contact) {
    const PatternDirection& direction = DirectionOf(row, contact);
    const int other = ElementOf(contact.part);
    if (RepeatsWith(direction, At(other), tolerance_)) return absl::OkStatus();
    if (GoesAlong(direction, At(other), tolerance_)) {
      if (EndsWhere(row, direction, other) || EndsWhere(other, direction, row)) {
        return absl::OkStatus();
      }
    } else if (!contact.stands_between) {
      MORTISE_ASSIGN_OR_RETURN(const bool keeps, Keeps(row, direction, other));
      if (keeps) return absl::OkStatus();
    }
    Lose(row, contact.part);
    return absl::OkStatus();
  }

  // Has a row that goes on beyond another end where that does, if something is there to end it.
  bool EndsWhere(int longer, const PatternDirection& direction, int shorter) {
    if (At(longer).parts.size() <= At(shorter).parts.size()) return false;
    bool ends = false;
    for (const PartialContact& contact : contacts_[static_cast<std::size_t>(longer)]) {
      const Element& beyond = At(ElementOf(contact.part));
      if (GoesAlong(direction, beyond, tolerance_)) continue;
      if (!GoesAlong(DirectionOf(longer, contact), At(shorter), tolerance_)) continue;
      Lose(longer, contact.part);
      ends = true;
    }
    return ends;
  }

  // Whether a row keeps what touches it in part.
  absl::StatusOr<bool> Keeps(int row, const PatternDirection& direction, int other) const {
    const Element& touching = At(other);
    const std::optional<Axis> axis = AxisOf(direction, tolerance_);
    if (!axis || (touching.pattern && LeadsAlong(*touching.pattern, static_cast<int>(*axis)))) {
      return false;  // it moves by itself
    }
    MORTISE_ASSIGN_OR_RETURN(const bool stays,
                             StaysAtAnEnd(elements_, row, other, *axis, feasible_set_, tolerance_));
    if (stays) return true;
    return BridgesGaps(elements_, row, other, *axis, feasible_set_);
  }

  const std::vector<Element>& elements_;
  const FeasibleSet& feasible_set_;
  const double tolerance_;
  const std::vector<int> element_of_;
  std::vector<std::vector<PartialContact>> contacts_;  // of each element
  PatternLosses lost_;
};

}  // namespace

absl::StatusOr<PatternLosses> FindPatternLosses(const Assembly& assembly,
                                                const std::vector<Element>& elements,
                                                const FeasibleSet& feasible_set, double tolerance) {
  return LossSearch(assembly, elements, feasible_set, tolerance).Find();
}

}  // namespace mortise::parametric
