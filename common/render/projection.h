// From points of space to samples of the picture. Internal to the renderer.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/render/camera.h"

namespace mortise::render {

// The camera's orthonormal axes.
struct ViewBasis {
  explicit ViewBasis(const Camera& camera)
      : eye(camera.eye), forward((camera.target - camera.eye).normalized()) {
    right = forward.cross(camera.up);
    if (right.norm() < 1e-9) right = forward.unitOrthogonal();  // looking along `up`
    right.normalize();
    up = right.cross(forward);
  }

  // Coordinates to the right, upwards and forwards of the eye, m.
  Eigen::Vector3d ToView(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d offset = point - eye;
    return {right.dot(offset), up.dot(offset), forward.dot(offset)};
  }

  Eigen::Vector3d eye, forward, right, up;
};

// A point in the picture: x to the right and y down in samples; `depth` grows away from the eye and
// is linear across a triangle; `weight` makes interpolation perspective-correct; not `visible`
// behind a perspective eye.
struct Projected {
  double x = 0;
  double y = 0;
  double depth = 0;
  double weight = 1;
  bool visible = true;
};

// Maps space to a rectangle of the sample grid in which the whole picture is seen, shrunk to fit.
class Projection {
 public:
  // `picture_*`: the size the camera was fitted for; `left`, `top`, `width`, `height`: the
  // rectangle of samples it is drawn into.
  Projection(const Camera& camera, double picture_width, double picture_height, double left,
             double top, double width, double height);

  Projected operator()(const Eigen::Vector3d& point) const;
  const ViewBasis& basis() const { return basis_; }

  // Returns the direction from a point towards the eye.
  Eigen::Vector3d TowardsEye(const Eigen::Vector3d& point) const;

 private:
  ViewBasis basis_;
  bool orthographic_;
  double scale_;  // samples a metre (orthographic), samples a unit of slope (perspective)
  double near_;
  double centre_x_, centre_y_;
};

}  // namespace mortise::render
