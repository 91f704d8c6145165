// The triangles of a part: those it has, or its outline triangulated twice, and two triangles a
// side.
#include "common/design/evaluation.h"
#include "common/design/polygon.h"

namespace mortise::parametric {

mesh::SurfaceMesh PartSurface(const EvaluatedPart& part) {
  if (part.faceted) return part.faceted->surface;
  const int corners = static_cast<int>(part.outline.cols());
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 2 * corners);
  for (int i = 0; i < corners; ++i) {
    const double u = part.outline(0, i), v = part.outline(1, i);
    surface.vertices.col(i) = FromPrismAxes(part.axis, u, v, part.from);
    surface.vertices.col(corners + i) = FromPrismAxes(part.axis, u, v, part.to);
  }
  const auto ends = Triangulate(part.outline);
  surface.triangles.resize(3, static_cast<Eigen::Index>(2 * ends.size()) + 2 * corners);
  Eigen::Index next = 0;
  for (const auto& [a, b, c] : ends) {
    surface.triangles.col(next++) << c, b, a;
    surface.triangles.col(next++) << corners + a, corners + b, corners + c;
  }
  for (int i = 0; i < corners; ++i) {
    const int j = (i + 1) % corners;
    surface.triangles.col(next++) << i, j, corners + j;
    surface.triangles.col(next++) << i, corners + j, corners + i;
  }
  return surface;
}

}  // namespace mortise::parametric
