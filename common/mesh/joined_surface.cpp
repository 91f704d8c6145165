#include "common/mesh/joined_surface.h"

namespace mortise::mesh {

SurfaceMesh Joined(const std::vector<SurfaceView>& surfaces) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const SurfaceView& surface : surfaces) {
    vertices += surface.vertices->cols();
    triangles += surface.triangles->cols();
  }
  SurfaceMesh joined{Eigen::Matrix3Xd(3, vertices), Eigen::Matrix3Xi(3, triangles)};
  vertices = triangles = 0;
  for (const SurfaceView& surface : surfaces) {
    joined.vertices.middleCols(vertices, surface.vertices->cols()) = *surface.vertices;
    joined.triangles.middleCols(triangles, surface.triangles->cols()) =
        surface.triangles->array() + static_cast<int>(vertices);
    vertices += surface.vertices->cols();
    triangles += surface.triangles->cols();
  }
  return joined;
}

SurfaceMesh Joined(const std::vector<SurfaceMesh>& surfaces) {
  std::vector<SurfaceView> views;
  views.reserve(surfaces.size());
  for (const SurfaceMesh& surface : surfaces) views.push_back(ViewOf(surface));
  return Joined(views);
}

}  // namespace mortise::mesh
