#include "services/interpolator/mapping/nearest_place.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <vector>

#include "services/interpolator/mapping/barycentric.h"

namespace mortise::interpolator {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Boxes = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 ToPoint(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

}  // namespace

// The boxes refer to the triangles, so neither moves.
struct NearestPlaces::Tree {
  explicit Tree(const mesh::SurfaceMesh& of) : surface(of) {
    triangles.reserve(static_cast<std::size_t>(of.triangles.cols()));
    for (const auto& corners : of.triangles.colwise()) {
      triangles.emplace_back(ToPoint(of.vertices.col(corners[0])),
                             ToPoint(of.vertices.col(corners[1])),
                             ToPoint(of.vertices.col(corners[2])));
    }
    boxes.insert(triangles.begin(), triangles.end());
    boxes.build();
    boxes.accelerate_distance_queries();
  }

  mesh::SurfaceMesh surface;
  Triangles triangles;
  Boxes boxes;
};

NearestPlaces::NearestPlaces(const mesh::SurfaceMesh& surface)
    : tree_(std::make_unique<const Tree>(surface)) {}

NearestPlaces::~NearestPlaces() = default;

TrianglePlace NearestPlaces::Find(const Eigen::Vector3d& point) const {
  const auto [place, triangle] = tree_->boxes.closest_point_and_primitive(ToPoint(point));
  const auto index = static_cast<int>(triangle - tree_->triangles.cbegin());
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k) {
    corners.col(k) = tree_->surface.vertices.col(tree_->surface.triangles(k, index));
  }
  return {index, BarycentricIn(corners, Eigen::Vector3d(place.x(), place.y(), place.z()))};
}

double NearestPlaces::Distance(const Eigen::Vector3d& point) const {
  return std::sqrt(tree_->boxes.squared_distance(ToPoint(point)));
}

}  // namespace mortise::interpolator
