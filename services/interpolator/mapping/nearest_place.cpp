#include "services/interpolator/mapping/nearest_place.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "common/mesh/surface_check.h"
#include "services/interpolator/mapping/guarded.h"

namespace mortise::interpolator {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Boxes = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 ToPoint(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

// Returns the share of the end of a segment in its point that is nearest to `point`.
double ShareOfEnd(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                  const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double square = along.squaredNorm();
  return square > 0 ? std::clamp((point - from).dot(along) / square, 0.0, 1.0) : 0;
}

// Returns the barycentric coordinates of the point of a triangle that is nearest to `point`: within
// it, or else on one of its sides, whichever rounding leaves.
Eigen::Vector3d NearestIn(const Eigen::Matrix3d& corners, const Eigen::Vector3d& point) {
  const Eigen::Vector3d a = corners.col(0), b = corners.col(1), c = corners.col(2);
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  const double of_b = (point - a).cross(c - a).dot(normal) / square;
  const double of_c = (b - a).cross(point - a).dot(normal) / square;
  if (of_b >= 0 && of_c >= 0 && of_b + of_c <= 1) return {1 - of_b - of_c, of_b, of_c};
  Eigen::Vector3d best = Eigen::Vector3d::UnitX();
  double least = (corners * best - point).squaredNorm();
  for (int side = 0; side < 3; ++side) {
    const int next = (side + 1) % 3;
    Eigen::Vector3d there = Eigen::Vector3d::Zero();
    there[next] = ShareOfEnd(point, corners.col(side), corners.col(next));
    there[side] = 1 - there[next];
    const double squared = (corners * there - point).squaredNorm();
    if (squared < least) {
      least = squared;
      best = there;
    }
  }
  return best;
}

}  // namespace

// The boxes refer to the triangles, so neither moves.
struct NearestPlaces::Tree {
  explicit Tree(const mesh::SurfaceMesh& of) {
    for (Eigen::Index t = 0; t < of.triangles.cols(); ++t) {
      const Eigen::Matrix3d at = of.vertices(Eigen::all, of.triangles.col(t));
      if (t == 0) first = at.col(0);
      if (mesh::IsDegenerate(at.col(0), at.col(1), at.col(2))) continue;
      corners.push_back(at);
      number.push_back(static_cast<int>(t));
      triangles.emplace_back(ToPoint(at.col(0)), ToPoint(at.col(1)), ToPoint(at.col(2)));
    }
    boxes.insert(triangles.cbegin(), triangles.cend());
    if (triangles.empty()) return;
    boxes.build();
    boxes.accelerate_distance_queries();
  }

  struct Found {
    TrianglePlace place;
    double distance = 0;
  };

  // What CGAL finds on a sliver may lie beside it. This is a point of the triangle in any case.
  Found Find(const Eigen::Vector3d& point) const {
    if (triangles.empty()) return {{0, Eigen::Vector3d::UnitX()}, (first - point).norm()};
    const auto [place, primitive] = boxes.closest_point_and_primitive(ToPoint(point));
    const auto found = static_cast<std::size_t>(primitive - triangles.cbegin());
    const Eigen::Vector3d shares = NearestIn(corners[found], point);
    return {{number[found], shares}, (corners[found] * shares - point).norm()};
  }

  std::vector<Eigen::Matrix3d> corners;
  std::vector<int> number;  // of each triangle that has an area
  Triangles triangles;
  Boxes boxes;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
};

absl::StatusOr<NearestPlaces> NearestPlaces::Create(const mesh::SurfaceMesh& surface) {
  return Guarded([&surface]() -> absl::StatusOr<NearestPlaces> {
    return NearestPlaces(std::make_unique<const Tree>(surface));
  });
}

NearestPlaces::NearestPlaces(std::unique_ptr<const Tree> tree) : tree_(std::move(tree)) {}
NearestPlaces::NearestPlaces(NearestPlaces&&) noexcept = default;
NearestPlaces& NearestPlaces::operator=(NearestPlaces&&) noexcept = default;
NearestPlaces::~NearestPlaces() = default;

absl::StatusOr<TrianglePlace> NearestPlaces::Find(const Eigen::Vector3d& point) const {
  return Guarded([&]() -> absl::StatusOr<TrianglePlace> { return tree_->Find(point).place; });
}

absl::StatusOr<double> NearestPlaces::Distance(const Eigen::Vector3d& point) const {
  return Guarded([&]() -> absl::StatusOr<double> { return tree_->Find(point).distance; });
}

}  // namespace mortise::interpolator
