#include "common/mesh/measures/inside_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kTried = 16;

struct Triangle {
  Vector3d a, b, c;
};

Triangle TriangleOf(const SurfaceMesh& surface, Eigen::Index t) {
  return {surface.vertices.col(surface.triangles(0, t)),
          surface.vertices.col(surface.triangles(1, t)),
          surface.vertices.col(surface.triangles(2, t))};
}

// Where the ray meets the triangle (Möller and Trumbore 1997), as a distance along it; infinity
// where it does not. Its rim counts, so that no ray slips through between two triangles.
double Hit(const Vector3d& origin, const Vector3d& direction, const Triangle& triangle) {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  constexpr double kRim = 1e-9;
  const Vector3d along = triangle.b - triangle.a, across = triangle.c - triangle.a;
  const Vector3d p = direction.cross(across);
  const double determinant = along.dot(p);
  if (std::abs(determinant) < 1e-14 * along.norm() * across.norm()) return kMiss;
  const Vector3d offset = origin - triangle.a;
  const double u = offset.dot(p) / determinant;
  const Vector3d r = offset.cross(along);
  const double v = direction.dot(r) / determinant;
  if (u < -kRim || v < -kRim || u + v > 1 + kRim) return kMiss;
  return across.dot(r) / determinant;
}

}  // namespace

absl::StatusOr<Vector3d> InsidePoint(const SurfaceMesh& surface) {
  const Eigen::Index count = surface.triangles.cols();
  std::vector<double> areas(static_cast<std::size_t>(count));
  for (Eigen::Index t = 0; t < count; ++t) {
    const Triangle triangle = TriangleOf(surface, t);
    areas[static_cast<std::size_t>(t)] =
        (triangle.b - triangle.a).cross(triangle.c - triangle.a).norm();
  }
  std::vector<Eigen::Index> order(areas.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return areas[static_cast<std::size_t>(a)] > areas[static_cast<std::size_t>(b)];
  });
  Vector3d best = Vector3d::Zero();
  double thickest = 0;
  for (std::size_t i = 0; i < std::min(kTried, order.size()); ++i) {
    const Triangle from = TriangleOf(surface, order[i]);
    const Vector3d normal = (from.b - from.a).cross(from.c - from.a);
    if (!(normal.norm() > 0)) continue;
    const Vector3d origin = (from.a + from.b + from.c) / 3;
    const Vector3d inwards = -normal.normalized();
    double depth = std::numeric_limits<double>::infinity();
    for (Eigen::Index t = 0; t < count; ++t) {
      if (t == order[i]) continue;
      const double hit = Hit(origin, inwards, TriangleOf(surface, t));
      if (hit > 0) depth = std::min(depth, hit);
    }
    if (std::isfinite(depth) && depth > thickest) {
      thickest = depth;
      best = origin + depth / 2 * inwards;
    }
  }
  if (thickest == 0) return InvalidField("surface", "has no inside");
  return best;
}

}  // namespace mortise::mesh
