// Finds a point inside a prism by a scan line through its outline.
#include "common/cad/interior_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace mortise::cad {
namespace {

// The height in the middle of the widest gap between neighbouring corners' heights.
double ScanHeight(const Eigen::Matrix2Xd& outline) {
  std::vector<double> heights(outline.row(1).begin(), outline.row(1).end());
  std::sort(heights.begin(), heights.end());
  double widest = 0, height = heights.front();
  for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
    if (heights[i + 1] - heights[i] <= widest) continue;
    widest = heights[i + 1] - heights[i];
    height = (heights[i] + heights[i + 1]) / 2;
  }
  return height;
}

}  // namespace

Eigen::Vector3d InteriorPoint(const mesh::PartShape& part) {
  const double height = ScanHeight(part.outline);
  std::vector<double> crossings;
  const Eigen::Index count = part.outline.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d a = part.outline.col(i), b = part.outline.col((i + 1) % count);
    if ((a.y() > height) == (b.y() > height)) continue;
    crossings.push_back(a.x() + (height - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::sort(crossings.begin(), crossings.end());
  double widest = 0, middle = 0;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    if (crossings[i + 1] - crossings[i] <= widest) continue;
    widest = crossings[i + 1] - crossings[i];
    middle = (crossings[i] + crossings[i + 1]) / 2;
  }
  return part.origin + middle * part.u + height * part.v + part.height / 2 * part.u.cross(part.v);
}

}  // namespace mortise::cad
