#include "common/mesh/measures/standing_solid.h"

// Boost's own headers include others of Boost that warn of themselves.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_point.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/ring.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace mortise::mesh {
namespace {

namespace geometry = boost::geometry;
using Point = geometry::model::d2::point_xy<double>;
using Points = geometry::model::multi_point<Point>;
using Polygon = geometry::model::ring<Point, false>;  // against the clock

constexpr double kTouches = 1e-5;  // of the diagonal

Points Footprint(std::span<const SurfaceMesh> solids, double touching_below) {
  Points footprint;
  for (const SurfaceMesh& solid : solids) {
    for (const auto& vertex : solid.vertices.colwise()) {
      if (vertex.z() <= touching_below) footprint.push_back(Point(vertex.x(), vertex.y()));
    }
  }
  return footprint;
}

// An edge of the support polygon, seen from a point.
struct Edge {
  Eigen::Vector2d from, to;  // against the clock
  Eigen::Vector2d outwards;  // unit vector across it

  // How far the point is within the line of the edge, m; negative beyond it.
  double Within(const Eigen::Vector2d& point) const { return outwards.dot(from - point); }

  Eigen::Vector2d NearestTo(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d along = to - from;
    return from + std::clamp(along.dot(point - from) / along.squaredNorm(), 0.0, 1.0) * along;
  }
};

// The edges; a line has two, one for each side.
std::vector<Edge> EdgesOf(const Support& support) {
  std::vector<Edge> edges;
  const Eigen::Index count = support.corners.cols();
  if (count < 2) return edges;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d from = support.corners.col(i);
    const Eigen::Vector2d to = support.corners.col((i + 1) % count);
    const Eigen::Vector2d along = (to - from).normalized();
    edges.push_back({from, to, {along.y(), -along.x()}});
  }
  return edges;
}

}  // namespace

Support SupportOf(std::span<const SurfaceMesh> solids) {
  Eigen::AlignedBox3d box;
  for (const SurfaceMesh& solid : solids) {
    for (const auto& vertex : solid.vertices.colwise()) box.extend(vertex.eval());
  }
  Support support;
  if (box.isEmpty()) return support;
  support.floor = box.min().z();
  Polygon polygon;
  geometry::convex_hull(Footprint(solids, support.floor + kTouches * box.diagonal().norm()),
                        polygon);
  // The ring is closed: its last point is its first.
  const auto count = static_cast<Eigen::Index>(polygon.empty() ? 0 : polygon.size() - 1);
  support.corners.resize(2, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point& corner = polygon[static_cast<std::size_t>(i)];
    support.corners.col(i) << corner.x(), corner.y();
  }
  // Points that are all one come as a ring of it alone.
  while (support.corners.cols() > 1 &&
         support.corners.col(support.corners.cols() - 1) == support.corners.col(0)) {
    support.corners.conservativeResize(Eigen::NoChange, support.corners.cols() - 1);
  }
  return support;
}

Standing StandOn(const Support& support, const Eigen::Vector3d& center_of_mass) {
  Standing standing;
  if (support.corners.cols() == 0) return standing;
  const Eigen::Vector2d below = center_of_mass.head<2>();
  bool is_within = support.corners.cols() > 2;
  double distance = (support.corners.col(0) - below).norm();
  Eigen::Vector2d nearest = support.corners.col(0);
  for (const Edge& edge : EdgesOf(support)) {
    is_within = is_within && edge.Within(below) >= 0;
    const Eigen::Vector2d point = edge.NearestTo(below);
    if ((point - below).norm() > distance) continue;
    distance = (point - below).norm();
    nearest = point;
    standing.falls_towards = edge.outwards;
  }
  if (!is_within && distance > 0) standing.falls_towards = (below - nearest) / distance;
  standing.margin = is_within ? distance : -distance;
  standing.angle = std::atan2(standing.margin, center_of_mass.z() - support.floor);
  return standing;
}

Standing StandOnFloor(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& center_of_mass) {
  return StandOn(SupportOf(solids), center_of_mass);
}

double TippingForce(const Support& support, const Eigen::Vector3d& center_of_mass, double weight,
                    const Eigen::Vector2d& point) {
  const std::vector<Edge> edges = EdgesOf(support);
  if (edges.empty()) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (const Edge& edge : edges) {
    const double within = edge.Within(center_of_mass.head<2>());
    if (within <= 0) return 0;
    const double beyond = -edge.Within(point);
    if (beyond > 0) least = std::min(least, weight * within / beyond);
  }
  return least;
}

}  // namespace mortise::mesh
