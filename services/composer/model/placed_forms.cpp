#include "services/composer/model/placed_forms.h"

#include <cmath>

#include "common/assembly/model/element.h"
#include "common/assembly/model/pattern.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::CenterVariable;
using parametric::Element;
using parametric::LinearForm;
using parametric::PatternLayout;
using parametric::SizeVariable;

// m. Layouts are linear between changes of their counts, so that a difference is exact whatever its
// step, but for rounding.
constexpr double kStep = 1e-5;
constexpr double kAsThin = 1.5;  // times the thinnest side

// How the size of the element's box along an axis changes a part of its row: the place of its
// middle, from that of the row, and its size.
struct Share {
  double of_center = 0, of_size = 1;
};

Share ShareOf(const Element& element, const BoundingBox& box, int index, int axis) {
  if (!element.pattern) return {};
  const PatternLayout now = parametric::LayOut(*element.pattern, box);
  for (const double step : {kStep, -kStep}) {
    BoundingBox other = box;
    other.minimum[axis] -= step / 2;
    other.maximum[axis] += step / 2;
    const PatternLayout then = parametric::LayOut(*element.pattern, other);
    if (then.part_count() != now.part_count()) continue;
    return {(then.CenterOf(index)[axis] - now.CenterOf(index)[axis]) / step,
            (then.part_size[axis] - now.part_size[axis]) / step};
  }
  return {0, 0};
}

}  // namespace

std::vector<PrincipalPart> PrincipalPartsOf(const Design& design) {
  const parametric::Assembly& drawn = design.assembly->assembly();
  const std::vector<Element>& elements = design.assembly->elements();
  std::vector<PrincipalPart> parts;
  std::vector<int> seen(elements.size(), 0);
  for (const parametric::PlacedPart& placed : PartsOf(design)) {
    const auto e = static_cast<std::size_t>(placed.element);
    const Element& element = elements[e];
    const int index = seen[e]++;
    if (element.connecting) continue;
    const BoundingBox box = ElementBox(design, placed.element);
    PrincipalPart& part = parts.emplace_back();
    part.name = placed.name;
    const bool is_drawn = index < static_cast<int>(element.parts.size());
    const int copied = element.parts[is_drawn ? static_cast<std::size_t>(index) : 0];
    part.drawn_as = drawn.parts[static_cast<std::size_t>(copied)].name;
    part.item = element.item;
    part.element = placed.element;
    part.box = placed.box;
    for (const Axis axis : parametric::kAxes) {
      const auto a = static_cast<std::size_t>(axis);
      const Share share = ShareOf(element, box, index, static_cast<int>(axis));
      const LinearForm whole = LinearForm::Variable(SizeVariable(placed.element, axis));
      part.center[a] = parametric::Combine(
          1, LinearForm::Variable(CenterVariable(placed.element, axis)), share.of_center, whole);
      part.size[a] = share.of_size * whole;
      // What the step rounds, and what a row's parts have whatever its box.
      part.center[a].constant =
          placed.box.center()[static_cast<int>(axis)] -
          (part.center[a].At(design.q) + design.shift[static_cast<int>(axis)]);
      part.size[a].constant = placed.box.size()[static_cast<int>(axis)] - part.size[a].At(design.q);
      const parametric::SizeLimits& limits =
          drawn.parts[static_cast<std::size_t>(copied)].limits[a];
      part.is_fixed[a] = limits.minimum == limits.maximum;
    }
  }
  return parts;
}

double DistanceBetween(const BoundingBox& a, const BoundingBox& b) {
  return (a.minimum - b.maximum).cwiseMax(b.minimum - a.maximum).cwiseMax(0).norm();
}

double CornerDistance(const BoundingBox& a, const BoundingBox& b) {
  return std::hypot((a.minimum - b.minimum).norm(), (a.maximum - b.maximum).norm());
}

bool ReachesAcross(const BoundingBox& box, Axis axis, double place, double tolerance) {
  const int at = static_cast<int>(axis);
  return box.minimum[at] < place - tolerance && box.maximum[at] > place + tolerance;
}

bool IsBroadAcross(const BoundingBox& box, Axis axis) {
  return box.size()[static_cast<int>(axis)] <= kAsThin * box.size().minCoeff();
}

LinearForm FaceOf(const PrincipalPart& part, Axis axis, bool upper) {
  const auto a = static_cast<std::size_t>(axis);
  return parametric::Combine(1, part.center[a], upper ? 0.5 : -0.5, part.size[a]);
}

}  // namespace mortise::composer
