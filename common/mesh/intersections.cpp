// The search for crossing triangles declared in surface_check.h.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

using Triangle = std::array<Eigen::Vector3d, 3>;

// Where the open segment a–b passes through the triangle, away from the segment's ends and, by
// `slack` (a fraction), from the triangle's border.
std::optional<Eigen::Vector3d> Pierce(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                      const Triangle& triangle, double slack) {
  const Eigen::Vector3d u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
  const Eigen::Vector3d normal = u.cross(v);
  const Eigen::Vector3d along = b - a;
  const double slope = normal.dot(along);
  if (std::abs(slope) <= 1e-12 * normal.norm() * along.norm()) return std::nullopt;
  const double t = normal.dot(triangle[0] - a) / slope;
  if (t <= slack || t >= 1 - slack) return std::nullopt;
  const Eigen::Vector3d point = a + t * along;
  const Eigen::Vector3d offset = point - triangle[0];
  const double area2 = normal.squaredNorm();
  const double wv = normal.dot(u.cross(offset)) / area2;
  const double wu = normal.dot(offset.cross(v)) / area2;
  if (wu < -slack || wv < -slack || wu + wv > 1 + slack) return std::nullopt;
  return point;
}

// A point common to two triangles in one plane, if they overlap by an area.
std::optional<Eigen::Vector3d> Overlap(const Triangle& first, const Triangle& second) {
  const Eigen::Vector3d normal = (first[1] - first[0]).cross(first[2] - first[0]);
  const double size = std::sqrt(normal.norm());
  for (const Eigen::Vector3d& corner : second) {
    if (std::abs(normal.normalized().dot(corner - first[0])) > 1e-9 * size) return std::nullopt;
  }
  // Clip the second triangle by the edges of the first; what remains must have an area.
  std::vector<Eigen::Vector3d> polygon(second.begin(), second.end());
  for (int k = 0; k < 3 && !polygon.empty(); ++k) {
    const Eigen::Vector3d inward = normal.cross(first[(k + 1) % 3] - first[k]);
    std::vector<Eigen::Vector3d> clipped;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d& p = polygon[i];
      const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
      const double dp = inward.dot(p - first[k]), dq = inward.dot(q - first[k]);
      if (dp >= 0) clipped.push_back(p);
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) clipped.push_back(p + dp / (dp - dq) * (q - p));
    }
    polygon = clipped;
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    centre += polygon[i] / polygon.size();
    if (i + 1 < polygon.size()) {
      area += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
    }
  }
  if (area.norm() <= 1e-9 * normal.norm()) return std::nullopt;
  return centre;
}

std::optional<Eigen::Vector3d> Meet(const Triangle& first, const Triangle& second, int shared) {
  if (const auto overlap = Overlap(first, second)) return overlap;
  if (shared >= 2) return std::nullopt;
  // Neighbours at a vertex touch at the border; strangers may not even touch from within.
  const double slack = shared == 1 ? 1e-9 : -1e-12;
  for (int k = 0; k < 3; ++k) {
    if (const auto point = Pierce(first[k], first[(k + 1) % 3], second, std::abs(slack))) {
      return point;
    }
    if (const auto point = Pierce(second[k], second[(k + 1) % 3], first, std::abs(slack))) {
      return point;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<Intersection> FindIntersections(const Eigen::Matrix3Xd& vertices,
                                            const Eigen::Matrix3Xi& triangles, int limit) {
  const int count = static_cast<int>(triangles.cols());
  std::vector<Eigen::AlignedBox3d> boxes(count);
  for (int t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k) boxes[t].extend(vertices.col(triangles(k, t)));
  }
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return boxes[a].min().x() < boxes[b].min().x(); });
  const auto corners = [&](int t) {
    return Triangle{vertices.col(triangles(0, t)), vertices.col(triangles(1, t)),
                    vertices.col(triangles(2, t))};
  };
  const auto shared = [&](int a, int b) {
    int common = 0;
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) common += triangles(k, a) == triangles(m, b);
    }
    return common;
  };
  std::vector<Intersection> found;
  std::vector<int> open;
  for (const int t : order) {
    std::erase_if(open, [&](int other) { return boxes[other].max().x() < boxes[t].min().x(); });
    for (const int other : open) {
      if (!boxes[t].intersects(boxes[other])) continue;
      const auto place = Meet(corners(t), corners(other), shared(t, other));
      if (!place) continue;
      found.push_back({std::min(t, other), std::max(t, other), *place});
      if (static_cast<int>(found.size()) >= limit) return found;
    }
    open.push_back(t);
  }
  return found;
}

}  // namespace mortise::mesh
