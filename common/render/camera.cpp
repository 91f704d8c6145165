// Fits cameras to boxes.
#include "common/render/camera.h"

#include <algorithm>
#include <cmath>

#include "common/render/projection.h"
#include "common/render/scene.h"

namespace mortise::render {

Camera FitCamera(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& direction, double aspect,
                 bool orthographic, double margin) {
  Camera camera;
  camera.orthographic = orthographic;
  if (box.isEmpty()) return camera;
  const double radius = std::max(0.5 * box.diagonal().norm(), 1e-9);
  camera.target = box.center();
  camera.eye = camera.target + 4 * radius * direction.normalized();
  const ViewBasis basis(camera);
  const double free = 1 - 2 * margin;

  // Orthographic: the larger of the two extents decides, after centring on the projected box.
  Eigen::AlignedBox3d seen;
  for (int i = 0; i < 8; ++i) {
    seen.extend(basis.ToView(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))));
  }
  const Eigen::Vector3d shift = basis.right * seen.center().x() + basis.up * seen.center().y();
  camera.eye += shift;
  camera.target += shift;
  camera.view_height =
      std::max({seen.sizes().y(), seen.sizes().x() / aspect, 1e-9 * radius}) / free;
  if (orthographic) return camera;

  // Perspective: far enough that every corner lies inside the cone of view, then sideways until the
  // picture is centred; each step changes the other a little less.
  const double tangent = std::tan(0.5 * camera.view_angle) * free;
  for (int round = 0; round < 6; ++round) {
    double distance = 0;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner =
          box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - camera.target;
      const double across =
          std::max(std::abs(basis.up.dot(corner)), std::abs(basis.right.dot(corner)) / aspect);
      distance = std::max(distance, -basis.forward.dot(corner) + across / tangent);
    }
    Eigen::AlignedBox2d slopes;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner =
          box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - camera.target;
      const double depth = distance + basis.forward.dot(corner);
      slopes.extend(Eigen::Vector2d(basis.right.dot(corner), basis.up.dot(corner)) / depth);
    }
    if (round < 5) {
      camera.target +=
          distance * (slopes.center().x() * basis.right + slopes.center().y() * basis.up);
    }
    camera.eye = camera.target - distance * basis.forward;
  }
  return camera;
}

Eigen::AlignedBox3d BoundingBox(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const Shape& shape : scene.shapes) {
    for (Eigen::Index i = 0; i < shape.vertices.cols(); ++i) box.extend(shape.vertices.col(i));
  }
  for (const Line& line : scene.lines) {
    for (Eigen::Index i = 0; i < line.points.cols(); ++i) box.extend(line.points.col(i));
  }
  for (const Label& label : scene.labels) box.extend(label.position);
  return box;
}

}  // namespace mortise::render
