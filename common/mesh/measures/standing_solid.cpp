#include "common/mesh/measures/standing_solid.h"

// Boost's own headers include others of Boost that warn of themselves.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <Eigen/Geometry>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/linestring.hpp>
#include <boost/geometry/geometries/multi_point.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/ring.hpp>
#include <cmath>

namespace mortise::mesh {
namespace {

namespace geometry = boost::geometry;
using Point = geometry::model::d2::point_xy<double>;
using Points = geometry::model::multi_point<Point>;
using Polygon = geometry::model::ring<Point>;
using Outline = geometry::model::linestring<Point>;

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

// Distance to the polygon's edge, negative outside.
double DistanceWithin(const Points& footprint, const Point& point) {
  Polygon polygon;
  geometry::convex_hull(footprint, polygon);
  const Outline outline(polygon.begin(), polygon.end());
  const double distance = geometry::distance(point, outline);
  return geometry::covered_by(point, polygon) ? distance : -distance;
}

}  // namespace

Standing StandOnFloor(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& center_of_mass) {
  Eigen::AlignedBox3d box;
  for (const SurfaceMesh& solid : solids) {
    for (const auto& vertex : solid.vertices.colwise()) box.extend(vertex.eval());
  }
  if (box.isEmpty()) return {};
  const double floor = box.min().z();
  const Points footprint = Footprint(solids, floor + kTouches * box.diagonal().norm());
  Standing standing;
  standing.margin = DistanceWithin(footprint, Point(center_of_mass.x(), center_of_mass.y()));
  standing.angle = std::atan2(standing.margin, center_of_mass.z() - floor);
  return standing;
}

}  // namespace mortise::mesh
