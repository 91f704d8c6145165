#include "common/render/projection.h"

#include <algorithm>
#include <cmath>

namespace mortise::render {

Projection::Projection(const Camera& camera, double picture_width, double picture_height,
                       double left, double top, double width, double height)
    : basis_(camera),
      orthographic_(camera.orthographic),
      near_(1e-3 * (camera.target - camera.eye).norm()),
      centre_x_(left + 0.5 * width),
      centre_y_(top + 0.5 * height) {
  const double shrink = std::min(width / picture_width, height / picture_height);
  scale_ = shrink * picture_height /
           (orthographic_ ? camera.view_height : 2 * std::tan(0.5 * camera.view_angle));
}

Projected Projection::operator()(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d view = basis_.ToView(point);
  Projected result;
  if (orthographic_) {
    result.x = centre_x_ + scale_ * view.x();
    result.y = centre_y_ - scale_ * view.y();
    result.depth = view.z();
    return result;
  }
  result.visible = view.z() > near_;
  if (!result.visible) return result;
  result.weight = 1 / view.z();
  result.x = centre_x_ + scale_ * view.x() * result.weight;
  result.y = centre_y_ - scale_ * view.y() * result.weight;
  result.depth = -result.weight;
  return result;
}

Eigen::Vector3d Projection::TowardsEye(const Eigen::Vector3d& point) const {
  if (orthographic_) return -basis_.forward;
  return (basis_.eye - point).normalized();
}

}  // namespace mortise::render
