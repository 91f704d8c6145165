#include "common/mesh/measures/silhouette.h"

#include <Eigen/Geometry>
#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "common/mesh/halfedge_mesh.h"

namespace mortise::mesh {
namespace {

using Contour = boost::polygon::polygon_set_data<int>;
using GridPoint = boost::polygon::point_data<int>;
using Edge = std::pair<int, int>;  // vertices, along its triangle's turn

constexpr double kGrid = 1 << 28;  // steps across the shadow

// Vertices in the plane across the light, 2 × V.
Eigen::Matrix2Xd Project(const SurfaceMesh& solid, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d u = direction.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> plane;
  plane << u.transpose(), direction.normalized().cross(u).transpose();
  return plane * solid.vertices;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// The edges around what faces the light: those that no other such triangle runs along backwards.
std::vector<Edge> ContourEdges(const SurfaceMesh& solid, const Eigen::Matrix2Xd& points) {
  const CutSurface surface(solid.vertices, solid.triangles);
  std::vector<bool> is_lit;
  for (const auto& triangle : solid.triangles.colwise()) {
    const Eigen::Vector2d first = points.col(triangle[0]);
    is_lit.push_back(Cross(points.col(triangle[1]) - first, points.col(triangle[2]) - first) > 0);
  }
  const auto faces_light = [&](OpenMesh::HalfedgeHandle halfedge) {
    const OpenMesh::FaceHandle face = surface.mesh().face_handle(halfedge);
    return face.is_valid() && is_lit[static_cast<std::size_t>(face.idx())];
  };
  std::vector<Edge> contour;
  for (const OpenMesh::HalfedgeHandle halfedge : surface.mesh().all_halfedges()) {
    const auto opposite = surface.mesh().opposite_halfedge_handle(halfedge);
    if (!faces_light(halfedge) || faces_light(opposite)) continue;
    contour.emplace_back(surface.CornerOf(halfedge), surface.CornerOf(opposite));
  }
  return contour;
}

// The way Boost counts windings along an edge of a polygon that turns to the left.
int Winding(const GridPoint& from, const GridPoint& to) { return from.x() == to.x() ? -1 : 1; }

// Of what the contours wind around, in steps of the grid squared.
double EnclosedArea(const Contour& contour) {
  contour.clean();
  long double twice = 0;
  for (auto element = contour.begin(); element != contour.end(); ++element) {
    const auto& [from, to] = element->first;
    const auto cross =
        static_cast<long double>(from.x()) * to.y() - static_cast<long double>(from.y()) * to.x();
    twice += element->second * Winding(from, to) * cross;
  }
  return static_cast<double>(std::abs(twice) / 2);
}

}  // namespace

double ProjectedArea(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& direction) {
  std::vector<Eigen::Matrix2Xd> points;
  Eigen::AlignedBox2d extent;
  for (const SurfaceMesh& solid : solids) {
    points.push_back(Project(solid, direction));
    for (const auto& point : points.back().colwise()) extent.extend(point.eval());
  }
  if (extent.isEmpty() || !(extent.sizes().maxCoeff() > 0)) return 0;
  const double step = extent.sizes().maxCoeff() / kGrid;
  const Eigen::Vector2d middle = extent.center();
  const auto on_grid = [&](const Eigen::Vector2d& point) {
    const Eigen::Vector2d scaled = (point - middle) / step;
    return GridPoint(static_cast<int>(std::lround(scaled.x())),
                     static_cast<int>(std::lround(scaled.y())));
  };
  Contour contour;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    for (const auto& [from, to] : ContourEdges(solids[i], points[i])) {
      const GridPoint a = on_grid(points[i].col(from)), b = on_grid(points[i].col(to));
      if (a != b) contour.insert(Contour::element_type({a, b}, Winding(a, b)));
    }
  }
  return EnclosedArea(contour) * step * step;
}

}  // namespace mortise::mesh
