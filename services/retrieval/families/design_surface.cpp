#include "services/retrieval/families/design_surface.h"

#include <vector>

#include "common/base/errors.h"
#include "common/design/evaluation.h"

namespace mortise::retrieval {
namespace {

mesh::SurfaceMesh Joined(const std::vector<mesh::SurfaceMesh>& surfaces) {
  Eigen::Index vertices = 0;
  Eigen::Index triangles = 0;
  for (const mesh::SurfaceMesh& surface : surfaces) {
    vertices += surface.vertices.cols();
    triangles += surface.triangles.cols();
  }
  mesh::SurfaceMesh joined{Eigen::Matrix3Xd(3, vertices), Eigen::Matrix3Xi(3, triangles)};
  vertices = triangles = 0;
  for (const mesh::SurfaceMesh& surface : surfaces) {
    joined.vertices.middleCols(vertices, surface.vertices.cols()) = surface.vertices;
    joined.triangles.middleCols(triangles, surface.triangles.cols()) =
        surface.triangles.array() + static_cast<int>(vertices);
    vertices += surface.vertices.cols();
    triangles += surface.triangles.cols();
  }
  return joined;
}

}  // namespace

mesh::SurfaceMesh DesignSurface(const parametric::EvaluatedDesign& design) {
  std::vector<mesh::SurfaceMesh> surfaces;
  for (const parametric::EvaluatedPart& part : design.parts) {
    surfaces.push_back(parametric::PartSurface(part));
  }
  return Joined(surfaces);
}

absl::StatusOr<mesh::SurfaceMesh> DesignSurface(const parametric::EvaluatedDesign& design,
                                                const std::set<std::string>& parts) {
  for (const std::string& part : parts) {
    if (parametric::FindPart(design, part) < 0) return ResourceNotFound(part);
  }
  std::vector<mesh::SurfaceMesh> surfaces;
  for (const parametric::EvaluatedPart& part : design.parts) {
    if (parts.contains(part.name)) surfaces.push_back(parametric::PartSurface(part));
  }
  return Joined(surfaces);
}

}  // namespace mortise::retrieval
