#include "common/assembly/model/element.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace mortise::parametric {
namespace {

constexpr double kSameFraction = 1e-9;  // of a size

// The box of all parts of an element.
BoundingBox BoxOf(const Assembly& assembly, const std::vector<int>& parts) {
  BoundingBox box = assembly.parts[static_cast<std::size_t>(parts.front())].box;
  for (const int index : parts) {
    const BoundingBox& part = assembly.parts[static_cast<std::size_t>(index)].box;
    box.minimum = box.minimum.cwiseMin(part.minimum);
    box.maximum = box.maximum.cwiseMax(part.maximum);
  }
  return box;
}

void AddBoxPlanes(Element& element) {
  for (const Axis axis : kAxes) {
    const std::string name = AxisName(axis);
    element.planes.push_back({name + " minimum", axis, -0.5, false});
    element.planes.push_back({name + " maximum", axis, 0.5, false});
  }
}

void AddPlane(const AssemblyPart& part, const ProminentPlane& plane, Element& element) {
  const int axis = static_cast<int>(plane.axis);
  element.planes.push_back({plane.name, plane.axis,
                            (plane.position - part.box.center()[axis]) / part.box.size()[axis],
                            false});
}

// Those that are no planes of the element already, along the axes that `is_wanted` says.
template <typename Predicate>
void AddLevels(const AssemblyPart& part, const Predicate& is_wanted, ShapeFeatures& known,
               Element& element) {
  if (part.shape == nullptr) return;
  std::array<int, 3> counts = {};
  for (const mesh::ShapeLevel& level : known.LevelsOf(*part.shape)) {
    const Axis axis = static_cast<Axis>(level.axis);
    const int count = ++counts[static_cast<std::size_t>(level.axis)];
    const auto plane =
        std::find_if(element.planes.begin(), element.planes.end(), [&](const ElementPlane& one) {
          return one.axis == axis && std::abs(one.fraction - level.fraction) < kSameFraction;
        });
    if (plane != element.planes.end()) plane->divides = level.divides;
    if (plane != element.planes.end() || !is_wanted(axis)) continue;
    element.levels.push_back(
        {absl::StrCat(AxisName(axis), " level ", count), axis, level.fraction, level.divides});
  }
}

// Unless a row of parts, or a tolerance of the drawing, makes its box another than it is wide.
void AddRoundAxis(const AssemblyPart& part, double tolerance, ShapeFeatures& known,
                  Element& element) {
  if (part.shape == nullptr) return;
  const std::optional<int> axis = known.RoundAboutOf(*part.shape);
  if (!axis) return;
  const int a = (*axis + 1) % 3, b = (*axis + 2) % 3;
  const Eigen::Vector3d size = element.box.size();
  const auto leads = [&](int along) {
    return element.pattern && LeadsAlong(*element.pattern, along);
  };
  if (leads(a) || leads(b) || std::abs(size[a] - size[b]) > tolerance) return;
  element.round_about = static_cast<Axis>(*axis);
}

Element ElementOfPart(const Assembly& assembly, int index, double tolerance, ShapeFeatures& known) {
  const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(index)];
  Element element;
  element.name = part.name;
  element.item = part.item;
  element.group = part.group;
  element.connecting = part.connecting;
  element.parts = {index};
  element.box = part.box;
  element.limits = part.limits;
  element.shape = part.shape;
  AddBoxPlanes(element);
  for (const ProminentPlane& plane : part.prominent_planes) AddPlane(part, plane, element);
  AddLevels(
      part, [](Axis) { return true; }, known, element);
  AddRoundAxis(part, tolerance, known, element);
  return element;
}

Element ElementOfPattern(const Assembly& assembly, const FoundPattern& found, double tolerance,
                         ShapeFeatures& known) {
  const AssemblyPart& first = assembly.parts[static_cast<std::size_t>(found.parts.front())];
  Element element;
  element.name = first.name;
  element.item = first.item;
  element.group = first.group;
  element.connecting = first.connecting;
  element.parts = found.parts;
  element.pattern = found.pattern;
  element.box = BoxOf(assembly, found.parts);
  element.limits = first.limits;
  element.shape = first.shape;
  for (int axis = 0; axis < 3; ++axis) {
    if (!LeadsAlong(found.pattern, axis)) continue;
    element.limits[static_cast<std::size_t>(axis)] =
        LengthsOf(found.pattern, axis, element.box.size()[axis], tolerance);
  }
  AddBoxPlanes(element);
  // All parts have these planes in one place, except along the pattern.
  const auto is_shared = [&](Axis axis) {
    return !LeadsAlong(found.pattern, static_cast<int>(axis));
  };
  for (const ProminentPlane& plane : first.prominent_planes) {
    if (is_shared(plane.axis)) AddPlane(first, plane, element);
  }
  AddLevels(first, is_shared, known, element);
  AddRoundAxis(first, tolerance, known, element);
  return element;
}

}  // namespace

std::vector<Element> MakeElements(const Assembly& assembly, double tolerance,
                                  const PatternExclusions& exclusions) {
  ShapeFeatures known;
  return MakeElements(assembly, tolerance, exclusions, known);
}

std::vector<Element> MakeElements(const Assembly& assembly, double tolerance,
                                  const PatternExclusions& exclusions, ShapeFeatures& known) {
  std::vector<Element> elements;
  std::vector<bool> taken(assembly.parts.size(), false);
  for (const FoundPattern& found : FindPatterns(assembly, tolerance, exclusions)) {
    elements.push_back(ElementOfPattern(assembly, found, tolerance, known));
    for (const int part : found.parts) taken[static_cast<std::size_t>(part)] = true;
  }
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    if (taken[i]) continue;
    elements.push_back(ElementOfPart(assembly, static_cast<int>(i), tolerance, known));
  }
  return elements;
}

std::vector<int> ElementsOfParts(const Assembly& assembly, const std::vector<Element>& elements) {
  std::vector<int> element_of(assembly.parts.size(), -1);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (const int part : elements[e].parts) {
      element_of[static_cast<std::size_t>(part)] = static_cast<int>(e);
    }
  }
  return element_of;
}

Eigen::VectorXd DrawnParameters(const std::vector<Element>& elements) {
  Eigen::VectorXd q(6 * static_cast<Eigen::Index>(elements.size()));
  for (std::size_t e = 0; e < elements.size(); ++e) {
    q.segment<3>(6 * static_cast<Eigen::Index>(e)) = elements[e].box.center();
    q.segment<3>(6 * static_cast<Eigen::Index>(e) + 3) = elements[e].box.size();
  }
  return q;
}

LinearForm PositionOf(int element, const ElementPlane& plane) {
  return Combine(1, LinearForm::Variable(CenterVariable(element, plane.axis)), plane.fraction,
                 LinearForm::Variable(SizeVariable(element, plane.axis)));
}

LinearForm PositionOf(const std::vector<Element>& elements, int element,
                      const ElementPlane& plane) {
  const std::vector<FeatureAnchor>& held =
      elements[static_cast<std::size_t>(element)]
          .feature_anchors[static_cast<std::size_t>(plane.axis)];
  if (held.empty() || std::abs(plane.fraction) == 0.5) return PositionOf(element, plane);
  FeatureAnchor low{-0.5, PositionOf(element, {"", plane.axis, -0.5, false})};
  FeatureAnchor high{0.5, PositionOf(element, {"", plane.axis, 0.5, false})};
  for (const FeatureAnchor& level : held) {
    if (std::abs(level.fraction - plane.fraction) < kSameFraction) return level.place;
    if (level.fraction < plane.fraction) {
      low = level;
    } else {
      high = level;
      break;
    }
  }
  const double share = (plane.fraction - low.fraction) / (high.fraction - low.fraction);
  return Combine(1 - share, low.place, share, high.place);
}

}  // namespace mortise::parametric
