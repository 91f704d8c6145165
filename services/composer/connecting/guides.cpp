#include "services/composer/connecting/guides.h"

#include <algorithm>
#include <cmath>

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::ElementConnection;
using parametric::ItemKind;
using parametric::Joint;
using parametric::JointKind;

constexpr double kParallel = 1 - 1e-4;  // cosine
constexpr double kAcross = 1e-4;        // the same, of what is at right angles
constexpr double kRounding = 1e-12;     // m
constexpr double kInside = 1e-3;        // m, by which a pivot's axis is within what is on it

// How far the axis of a hinge, or the point of a ball, goes by a box, m.
double DistanceFrom(const Joint& joint, const BoundingBox& box) {
  if (joint.kind == JointKind::kBall) {
    const Eigen::Vector3d nearest = joint.center.cwiseMax(box.minimum).cwiseMin(box.maximum);
    return (nearest - joint.center).norm();
  }
  // Where the axis is nearest to the box, by turns: both are convex.
  Eigen::Vector3d on_axis = box.center();
  for (int i = 0; i < 50; ++i) {
    on_axis = joint.center + joint.axis * joint.axis.dot(on_axis - joint.center);
    const Eigen::Vector3d in_box = on_axis.cwiseMax(box.minimum).cwiseMin(box.maximum);
    if ((in_box - on_axis).norm() < kRounding) return 0;
    on_axis = in_box;
  }
  const Eigen::Vector3d along = on_axis - joint.center;
  return (along - joint.axis * joint.axis.dot(along)).norm();
}

bool IsOnAxis(const Joint& joint, const BoundingBox& box, double tolerance) {
  return DistanceFrom(joint, box) <= tolerance;
}

// Whether it goes through the inside of a box, not along its edge as that of a door does.
bool IsInside(const Joint& joint, const BoundingBox& box) {
  const Eigen::Vector3d within = (box.size() / 2).cwiseMin(Eigen::Vector3d::Constant(kInside));
  return DistanceFrom(joint, {box.minimum + within, box.maximum - within}) == 0;
}

// Whether the item of a connecting element is long along the axis of a slide.
bool LiesAlong(const ElementConnection& connection, int element, const Joint& joint) {
  const parametric::Element& of = connection.elements[static_cast<std::size_t>(element)];
  const parametric::AssemblyPart& part =
      connection.assembly.parts[static_cast<std::size_t>(of.parts.front())];
  return std::abs(joint.axis[static_cast<Eigen::Index>(part.item_axes[0])]) >= kParallel;
}

}  // namespace

bool LetsMove(const ElementConnection& connection, int element, const Joint& joint,
              const ItemKindOf& kind_of) {
  const parametric::Element& of = connection.elements[static_cast<std::size_t>(element)];
  const bool slides = joint.kind == JointKind::kPrismatic;
  const auto on_axis = [&] { return IsOnAxis(joint, of.box, connection.tolerance); };
  const auto along = [&] { return LiesAlong(connection, element, joint); };
  const std::optional<ItemKind> kind = kind_of ? kind_of(of.item) : std::nullopt;
  if (!kind) return slides || on_axis();
  switch (*kind) {
    case ItemKind::kHinge:
      return joint.kind == JointKind::kHinge && on_axis();
    case ItemKind::kDrawerSlide:
      return slides && along();
    case ItemKind::kScrew:
    case ItemKind::kWheel:
      return !slides && on_axis();
    case ItemKind::kBearing:
    case ItemKind::kBolt:
    case ItemKind::kDowel:
    case ItemKind::kThreadedRod:
    case ItemKind::kTube:
      return slides ? along() : on_axis();
    case ItemKind::kHardware:
    case ItemKind::kProfile:
      return slides || on_axis();
    default:
      return false;
  }
}

bool Guides(const ElementConnection& connection, const Joint& joint, const ItemKindOf& kind_of) {
  for (int e = connection.principal_count(); e < static_cast<int>(connection.elements.size());
       ++e) {
    if (LetsMove(connection, e, joint, kind_of)) return true;
  }
  return false;
}

bool IsMadeToMove(const ElementConnection& connection, const ItemKindOf& kind_of) {
  if (!kind_of) return false;
  const auto first = connection.elements.begin() + connection.principal_count();
  return std::any_of(first, connection.elements.end(), [&](const parametric::Element& element) {
    const std::optional<ItemKind> kind = kind_of(element.item);
    return kind == ItemKind::kHinge || kind == ItemKind::kDrawerSlide || kind == ItemKind::kBearing;
  });
}

bool Guidance::IsOfWay(const Joint& joint, parametric::Axis normal) {
  return joint.kind != JointKind::kPrismatic ||
         std::abs(joint.axis[static_cast<Eigen::Index>(normal)]) <= kAcross;
}

void Guidance::AddContact(const Joint& joint, const BoundingBox& moved, const BoundingBox& other,
                          parametric::Axis normal) {
  if (!IsOfWay(joint, normal)) return;
  if (joint.kind == JointKind::kPrismatic) {
    const auto axis = static_cast<std::size_t>(normal);
    const auto at = static_cast<Eigen::Index>(normal);
    is_blocked_[axis][other.center()[at] > moved.center()[at] ? 1 : 0] = true;
    return;
  }
  has_pivot_ = has_pivot_ || (IsInside(joint, moved) && IsInside(joint, other));
}

bool Guidance::Keeps() const {
  return has_pivot_ || std::any_of(is_blocked_.begin(), is_blocked_.end(),
                                   [](const auto& sides) { return sides[0] && sides[1]; });
}

bool Guidance::Covers(const Guidance& other) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (other.is_blocked_[axis][side] && !is_blocked_[axis][side]) return false;
    }
  }
  return has_pivot_ || !other.has_pivot_;
}

}  // namespace mortise::composer
