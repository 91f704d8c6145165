#include "common/parametric/element.h"

#include <algorithm>
#include <cmath>

namespace mortise::parametric {
namespace {

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
    element.planes.push_back({name + " minimum", axis, -0.5});
    element.planes.push_back({name + " maximum", axis, 0.5});
  }
}

Element ElementOfPart(const Assembly& assembly, int index) {
  const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(index)];
  Element element;
  element.name = part.name;
  element.item = part.item;
  element.group = part.group;
  element.connecting = part.connecting;
  element.parts = {index};
  element.box = part.box;
  element.limits = part.limits;
  AddBoxPlanes(element);
  for (const ProminentPlane& plane : part.prominent_planes) {
    const int axis = static_cast<int>(plane.axis);
    element.planes.push_back({plane.name, plane.axis,
                              (plane.position - part.box.center()[axis]) / part.box.size()[axis]});
  }
  return element;
}

// The sizes a pattern may take along an axis it leads along.
SizeLimits LimitsAlong(const Pattern& pattern, double drawn, int axis) {
  double smallest_spacing = 0;
  for (const PatternDirection& direction : pattern.directions) {
    if (direction.count > 1) smallest_spacing += std::abs(direction.spacing[axis]);
  }
  // Two parts side by side, or at their drawn spacing where they overlap in the drawing.
  const double room = std::min(smallest_spacing, pattern.part_size[axis]) + pattern.part_size[axis];
  return {std::min(std::max(drawn / 2, room), drawn), 2 * drawn};
}

Element ElementOfPattern(const Assembly& assembly, const FoundPattern& found) {
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
  for (int axis = 0; axis < 3; ++axis) {
    bool led = false;
    for (const PatternDirection& direction : found.pattern.directions) {
      led |= direction.count > 1 &&
             std::abs(direction.spacing[axis]) > 1e-9 * direction.spacing.norm();
    }
    if (led) {
      element.limits[static_cast<std::size_t>(axis)] =
          LimitsAlong(found.pattern, element.box.size()[axis], axis);
    }
  }
  AddBoxPlanes(element);
  return element;
}

}  // namespace

std::vector<Element> MakeElements(const Assembly& assembly, double tolerance) {
  std::vector<Element> elements;
  std::vector<bool> taken(assembly.parts.size(), false);
  for (const FoundPattern& found : FindPatterns(assembly, tolerance)) {
    elements.push_back(ElementOfPattern(assembly, found));
    for (const int part : found.parts) taken[static_cast<std::size_t>(part)] = true;
  }
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    if (!taken[i]) elements.push_back(ElementOfPart(assembly, static_cast<int>(i)));
  }
  return elements;
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

}  // namespace mortise::parametric
