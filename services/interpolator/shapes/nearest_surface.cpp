#include "services/interpolator/shapes/nearest_surface.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "common/mesh/surface_check.h"

namespace mortise::interpolator {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using BoxTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 ToPoint(const Eigen::Vector3d& place) { return {place.x(), place.y(), place.z()}; }

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

// It refers to the triangles, so that neither moves.
struct NearestSurface::Tree {
  std::vector<Eigen::Matrix3d> corners;
  std::vector<int> number;  // of each triangle that has an area
  Triangles triangles;
  BoxTree boxes;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
};

NearestSurface::NearestSurface(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix3Xi& triangles) {
  auto tree = std::make_unique<Tree>();
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = nodes(Eigen::all, triangles.col(t));
    if (t == 0) tree->first = corners.col(0);
    if (mesh::IsDegenerate(corners.col(0), corners.col(1), corners.col(2))) continue;
    tree->corners.push_back(corners);
    tree->number.push_back(static_cast<int>(t));
    tree->triangles.emplace_back(ToPoint(corners.col(0)), ToPoint(corners.col(1)),
                                 ToPoint(corners.col(2)));
  }
  tree->boxes.insert(tree->triangles.cbegin(), tree->triangles.cend());
  // It would be built when it is first asked, by whichever threads do so.
  if (!tree->triangles.empty()) {
    tree->boxes.build();
    tree->boxes.accelerate_distance_queries();
  }
  tree_ = std::move(tree);
}

NearestSurface::~NearestSurface() = default;

SurfacePoint NearestSurface::Find(const Eigen::Vector3d& point) const {
  if (tree_->triangles.empty()) {
    return {{0, Eigen::Vector3d::UnitX()}, (tree_->first - point).norm()};
  }
  const auto [nearest, primitive] = tree_->boxes.closest_point_and_primitive(ToPoint(point));
  const auto found = static_cast<std::size_t>(primitive - tree_->triangles.cbegin());
  // What CGAL says of a sliver may lie beside it. This is a point of the triangle in any case.
  const Eigen::Vector3d shares = NearestIn(tree_->corners[found], point);
  return {{tree_->number[found], shares}, (tree_->corners[found] * shares - point).norm()};
}

}  // namespace mortise::interpolator
