// Where a picture is taken from.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace mortise::render {

struct Scene;

// A camera at `eye` looking at `target`. The world is right-handed, z upwards by custom.
struct Camera {
  Eigen::Vector3d eye{1, -1, 1};    // m
  Eigen::Vector3d target{0, 0, 0};  // m
  Eigen::Vector3d up{0, 0, 1};      // need not be orthogonal to the view
  bool orthographic = true;
  double view_height = 1;   // orthographic: height of the visible rectangle through target, m
  double view_angle = 0.6;  // perspective: full vertical angle, rad
};

// Usual views; a direction points from the target to the eye.
inline const Eigen::Vector3d kViewIsometric{1.0, -1.35, 0.85};
inline const Eigen::Vector3d kViewFront{0, -1, 0};
inline const Eigen::Vector3d kViewRight{1, 0, 0};
inline const Eigen::Vector3d kViewTop{0, -1e-6, 1};

// Returns a camera that sees `box` whole from `direction` (box centre to eye) in a picture of
// `aspect` = width / height, leaving `margin` (a fraction of the picture) free all round.
Camera FitCamera(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& direction, double aspect,
                 bool orthographic = true, double margin = 0.06);

// Returns the box around everything drawn in the scene.
Eigen::AlignedBox3d BoundingBox(const Scene& scene);

}  // namespace mortise::render
