#include "services/fabplanner/design.h"

#include <algorithm>

namespace mortise::fabplanner {
namespace {

// The point of the outline at height `along` in the design's coordinates.
Eigen::Vector3d PointOf(const Part& part, const Eigen::Vector2d& point, double along) {
  Eigen::Vector3d result;
  result[part.extrusion_axis] = along;
  result[(part.extrusion_axis + 1) % 3] = point.x();
  result[(part.extrusion_axis + 2) % 3] = point.y();
  return result;
}

double SignedArea(const std::vector<Eigen::Vector2d>& outline) {
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area / 2;
}

}  // namespace

Eigen::AlignedBox3d BoundsOf(const Part& part) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector2d& point : part.outline) {
    box.extend(PointOf(part, point, part.from));
    box.extend(PointOf(part, point, part.to));
  }
  return box;
}

std::vector<Eigen::Vector2d> SheetOutlineOf(const Part& part) {
  if (part.extrusion_axis != part.thickness_axis) {
    return {{0, 0}, {part.size.x(), 0}, {part.size.x(), part.size.y()}, {0, part.size.y()}};
  }
  const Eigen::Vector3d along_length = Eigen::Vector3d::Unit(part.length_axis);
  const Eigen::Vector3d along_width =
      Eigen::Vector3d::Unit(part.thickness_axis).cross(along_length);
  std::vector<Eigen::Vector2d> outline;
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(1e300);
  for (const Eigen::Vector2d& point : part.outline) {
    const Eigen::Vector3d corner = PointOf(part, point, part.to);
    outline.emplace_back(corner.dot(along_length), corner.dot(along_width));
    lower = lower.cwiseMin(outline.back());
  }
  for (Eigen::Vector2d& point : outline) point -= lower;
  if (SignedArea(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

}  // namespace mortise::fabplanner
