#include "services/composer/model/quarter_turn.h"

#include <map>
#include <memory>
#include <utility>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::composer {
namespace {

using parametric::Axis;

// x becomes y, and y becomes -x; exactly.
Eigen::Vector3d Turned(const Eigen::Vector3d& v) { return {-v.y(), v.x(), v.z()}; }

Axis Turned(Axis axis) {
  return axis == Axis::kX ? Axis::kY : axis == Axis::kY ? Axis::kX : Axis::kZ;
}

void Turn(parametric::AssemblyPart& part) {
  const Eigen::Vector3d a = Turned(part.box.minimum);
  const Eigen::Vector3d b = Turned(part.box.maximum);
  part.box = {a.cwiseMin(b), a.cwiseMax(b)};
  std::swap(part.limits[0], part.limits[1]);
  for (Axis& axis : part.item_axes) axis = Turned(axis);
  for (parametric::ProminentPlane& plane : part.prominent_planes) {
    if (plane.axis == Axis::kY) plane.position = -plane.position;
    plane.axis = Turned(plane.axis);
  }
}

void Turn(parametric::Joint& joint) {
  joint.center = Turned(joint.center);
  joint.axis = Turned(joint.axis);
  for (parametric::RestPose& pose : joint.rest_poses) pose.motion = Turned(pose.motion);
}

}  // namespace

parametric::Assembly QuarterTurned(parametric::Assembly assembly, int turns) {
  const int quarters = ((turns % 4) + 4) % 4;
  // Parts that share a shape go on sharing one.
  std::map<const mesh::DrawnShape*, std::shared_ptr<const mesh::DrawnShape>> shapes;
  const auto turned_shape = [&](const std::shared_ptr<const mesh::DrawnShape>& shape) {
    std::shared_ptr<const mesh::DrawnShape>& known = shapes[shape.get()];
    if (known == nullptr) {
      mesh::DrawnShape made = *shape;
      for (int i = 0; i < quarters; ++i) made = mesh::Turned(made, 1, 2);
      known = std::make_shared<const mesh::DrawnShape>(std::move(made));
    }
    return known;
  };
  if (quarters == 0) return assembly;
  for (parametric::AssemblyPart& part : assembly.parts) {
    for (int i = 0; i < quarters; ++i) Turn(part);
    if (part.shape != nullptr) part.shape = turned_shape(part.shape);
  }
  for (parametric::Joint& joint : assembly.joints) {
    for (int i = 0; i < quarters; ++i) Turn(joint);
  }
  return assembly;
}

}  // namespace mortise::composer
