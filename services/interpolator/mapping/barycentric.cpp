#include "services/interpolator/mapping/barycentric.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace mortise::interpolator {
namespace {

Eigen::Vector3d OnLongestSide(const Eigen::Matrix3d& corners, const Eigen::Vector3d& point) {
  int start = 0;
  double longest = -1;
  for (int k = 0; k < 3; ++k) {
    const double length = (corners.col((k + 1) % 3) - corners.col(k)).squaredNorm();
    if (length <= longest) continue;
    longest = length;
    start = k;
  }
  const Eigen::Vector3d from = corners.col(start), along = corners.col((start + 1) % 3) - from;
  const double share = longest > 0 ? std::clamp((point - from).dot(along) / longest, 0.0, 1.0) : 0;
  Eigen::Vector3d shares = Eigen::Vector3d::Zero();
  shares[start] = 1 - share;
  shares[(start + 1) % 3] = share;
  return shares;
}

}  // namespace

Eigen::Vector3d BarycentricIn(const Eigen::Matrix3d& corners, const Eigen::Vector3d& point) {
  const Eigen::Vector3d ab = corners.col(1) - corners.col(0), ac = corners.col(2) - corners.col(0);
  const Eigen::Vector3d ap = point - corners.col(0), normal = ab.cross(ac);
  const double square = normal.squaredNorm();
  if (!(square > 0)) return OnLongestSide(corners, point);
  const double of_b = ap.cross(ac).dot(normal) / square, of_c = ab.cross(ap).dot(normal) / square;
  const Eigen::Vector3d inside = Eigen::Vector3d(1 - of_b - of_c, of_b, of_c).cwiseMax(0.0);
  return inside / inside.sum();
}

}  // namespace mortise::interpolator
