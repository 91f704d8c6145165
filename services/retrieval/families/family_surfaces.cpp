#include "services/retrieval/families/family_surfaces.h"

#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/retrieval/families/design_surface.h"

namespace mortise::retrieval {

FitFamily SurfacesOf(std::shared_ptr<const templates::Template> function) {
  const std::vector<parametric::Parameter>& parameters = function->parameters();
  FitFamily family;
  family.surfaces.lower.resize(static_cast<Eigen::Index>(parameters.size()));
  family.surfaces.upper.resize(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    family.surfaces.lower[static_cast<Eigen::Index>(i)] = parameters[i].minimum;
    family.surfaces.upper[static_cast<Eigen::Index>(i)] = parameters[i].maximum;
  }
  family.surfaces.surface = [function = std::move(function)](
                                const Eigen::VectorXd& q) -> absl::StatusOr<mesh::SurfaceMesh> {
    MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design, function->Evaluate(q));
    return DesignSurface(design);
  };
  return family;
}

}  // namespace mortise::retrieval
