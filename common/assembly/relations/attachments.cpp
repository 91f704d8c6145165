#include "common/assembly/relations/attachments.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/pattern.h"

namespace mortise::parametric {
namespace {

// The equality that keeps `form` as drawn, which the drawing may miss by less than the tolerance.
void AddTie(RelationshipKind kind, LinearForm form, int group, std::string label,
            const Eigen::VectorXd& drawn, std::vector<Relationship>& ties) {
  if (form.terms.empty()) return;  // true whatever q is
  form.constant -= form.At(drawn);
  ties.push_back({kind, true, std::move(form), group, std::move(label)});
}

bool LeadsAlong(const Element& element, int axis) {
  return element.pattern && parametric::LeadsAlong(*element.pattern, axis);
}

// Whether the item of an element's parts fixes all of their sizes.
bool IsOfFixedSize(const Assembly& assembly, const Element& element) {
  const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(element.parts.front())];
  return std::all_of(part.limits.begin(), part.limits.end(),
                     [](const SizeLimits& limits) { return limits.minimum == limits.maximum; });
}

bool Overlap(const BoundingBox& a, const BoundingBox& b, double tolerance) {
  const Eigen::Array3d overlap = a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum);
  return overlap.minCoeff() > tolerance;
}

// Whether one element lies within another along an axis, which it may be drawn to miss.
bool LiesWithin(const BoundingBox& inner, const BoundingBox& outer, int axis, double tolerance) {
  return inner.minimum[axis] >= outer.minimum[axis] - tolerance &&
         inner.maximum[axis] <= outer.maximum[axis] + tolerance;
}

// Where `place` is drawn, at the distance of a position: a share of the element's size within it,
// and the same beyond it.
LinearForm PlaceBeside(const Element& element, const PosedPosition& position, double place,
                       double tolerance) {
  const int axis = static_cast<int>(position.axis);
  const double apart = place - position.drawn;
  const bool is_within =
      place > element.box.minimum[axis] && place < element.box.maximum[axis] && !element.pattern;
  if (!is_within || std::abs(apart) <= tolerance) return position.position;
  return Combine(1, position.position, apart / element.box.size()[axis],
                 LinearForm::Variable(SizeVariable(position.element, position.axis)));
}

}  // namespace

std::vector<Relationship> TiePatterns(const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const Contacts& contacts, double tolerance) {
  const Eigen::VectorXd drawn = DrawnParameters(assembly, elements);
  std::vector<Relationship> ties;
  for (const auto& [a, b] : contacts) {
    const Element& one = elements[static_cast<std::size_t>(a)];
    const Element& other = elements[static_cast<std::size_t>(b)];
    if (!one.pattern || !other.pattern) continue;
    for (const Axis axis : kAxes) {
      if (!CommonDirection(*one.pattern, *other.pattern, static_cast<int>(axis), tolerance)) {
        continue;
      }
      const int group = LowestCommonGroup(assembly, one.group, other.group);
      const std::string label = absl::StrCat("'", one.name, "' repeats along ", AxisName(axis),
                                             " with '", other.name, "'");
      AddTie(RelationshipKind::kRepeat,
             LinearForm::Variable(CenterVariable(a, axis)) -
                 LinearForm::Variable(CenterVariable(b, axis)),
             group, label, drawn, ties);
      AddTie(
          RelationshipKind::kRepeat,
          LinearForm::Variable(SizeVariable(a, axis)) - LinearForm::Variable(SizeVariable(b, axis)),
          group, label, drawn, ties);
    }
  }
  return ties;
}

std::vector<Relationship> TieFasteners(const Assembly& assembly,
                                       const std::vector<Element>& elements,
                                       const Contacts& contacts, double tolerance) {
  const Eigen::VectorXd drawn = DrawnParameters(assembly, elements);
  std::vector<Relationship> ties;
  const auto tie = [&](int fastener, int bought) {
    const Element& one = elements[static_cast<std::size_t>(fastener)];
    const Element& other = elements[static_cast<std::size_t>(bought)];
    if (!one.connecting || !IsOfFixedSize(assembly, other) ||
        !Overlap(one.box, other.box, tolerance)) {
      return;
    }
    const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(one.parts.front())];
    for (const Axis axis : kAxes) {
      const int index = static_cast<int>(axis);
      if (axis == part.item_axes[0] || LeadsAlong(other, index) ||
          !LiesWithin(one.box, other.box, index, tolerance)) {
        continue;
      }
      const int group = LowestCommonGroup(assembly, one.group, other.group);
      const std::string label = absl::StrCat("'", one.name, "' in its place on '", other.name,
                                             "' along ", AxisName(axis));
      AddTie(RelationshipKind::kProportion,
             LinearForm::Variable(CenterVariable(fastener, axis)) -
                 LinearForm::Variable(CenterVariable(bought, axis)),
             group, label, drawn, ties);
      if (LeadsAlong(one, index)) {
        AddTie(RelationshipKind::kProportion, LinearForm::Variable(SizeVariable(fastener, axis)),
               group, label, drawn, ties);
      }
    }
  };
  for (const auto& [a, b] : contacts) {
    tie(a, b);
    tie(b, a);
  }
  return ties;
}

std::vector<Relationship> TieJoints(const Assembly& assembly, const std::vector<Element>& elements,
                                    const std::vector<PosedPosition>& positions, double tolerance) {
  const Eigen::VectorXd drawn = DrawnParameters(assembly, elements);
  std::vector<Relationship> ties;
  for (std::size_t j = 0; j < assembly.joints.size(); ++j) {
    const Joint& joint = assembly.joints[j];
    for (const Axis axis : kAxes) {
      const double center = joint.center[static_cast<int>(axis)];
      const PosedPosition* nearest = nullptr;
      for (const PosedPosition& position : positions) {
        const Element& element = elements[static_cast<std::size_t>(position.element)];
        if (position.axis != axis || !IsWithin(assembly, element.group, joint.group)) continue;
        if (nearest == nullptr ||
            std::abs(position.drawn - center) < std::abs(nearest->drawn - center)) {
          nearest = &position;
        }
      }
      if (nearest == nullptr) continue;
      const Element& beside = elements[static_cast<std::size_t>(nearest->element)];
      const int variable = JointVariable(elements.size(), static_cast<int>(j), axis);
      AddTie(RelationshipKind::kConcentric,
             LinearForm::Variable(variable) - PlaceBeside(beside, *nearest, center, tolerance),
             assembly.groups[static_cast<std::size_t>(joint.group)].parent,
             absl::StrCat("the centre of '", joint.name, "' level along ", AxisName(axis), " with ",
                          nearest->label),
             drawn, ties);
    }
  }
  return ties;
}

}  // namespace mortise::parametric
