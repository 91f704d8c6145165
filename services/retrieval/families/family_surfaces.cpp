#include "services/retrieval/families/family_surfaces.h"

#include <utility>

#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "services/retrieval/families/design_surface.h"

namespace mortise::retrieval {

FitFamily SurfacesOf(std::shared_ptr<const templates::Template> function,
                     const ParameterDomain& domain) {
  FitFamily family;
  family.surfaces.lower = domain.lower;
  family.surfaces.upper = domain.upper;
  family.cuts = domain.cuts;
  family.surfaces.surface = [function = std::move(function)](
                                const Eigen::VectorXd& q) -> absl::StatusOr<mesh::SurfaceMesh> {
    // Nothing lies between whole numbers: a fit stays with those that it began with.
    MORTISE_ASSIGN_OR_RETURN(
        const parametric::EvaluatedDesign design,
        function->Evaluate(parametric::WithWholeNumbers(function->parameters(), q)));
    return DesignSurface(design);
  };
  return family;
}

}  // namespace mortise::retrieval
