#include "services/retrieval/families/design_surface.h"

#include <vector>

#include "common/base/errors.h"
#include "common/design/evaluation.h"
#include "common/mesh/joined_surface.h"

namespace mortise::retrieval {
mesh::SurfaceMesh DesignSurface(const parametric::EvaluatedDesign& design) {
  std::vector<mesh::SurfaceMesh> surfaces;
  for (const parametric::EvaluatedPart& part : design.parts) {
    surfaces.push_back(parametric::PartSurface(part));
  }
  return mesh::Joined(surfaces);
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
  return mesh::Joined(surfaces);
}

}  // namespace mortise::retrieval
