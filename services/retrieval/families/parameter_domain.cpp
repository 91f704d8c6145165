#include "services/retrieval/families/parameter_domain.h"

#include <vector>

#include "common/assembly/polyhedra/polyhedron_extents.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"

namespace mortise::retrieval {
namespace {

// Of how far designs go along a limit among parameters: so far within it is known to be, however
// evaluations round.
constexpr double kWithin = 1e-6;

// The limits among parameters, each a little within.
absl::StatusOr<LinearConstraints> CutsOf(const templates::Template& design_template,
                                         const LinearConstraints& box) {
  MORTISE_ASSIGN_OR_RETURN(auto limits, design_template.LimitsAmongParameters());
  if (limits.bounds.size() == 0) return LinearConstraints{limits.normals, limits.bounds};
  const LinearConstraints all = BothConstraints(box, {limits.normals, limits.bounds});
  MORTISE_ASSIGN_OR_RETURN(const parametric::Extents extents,
                           parametric::ExtentsAlong(all.normals, all.bounds, limits.normals));
  limits.bounds -= kWithin * (extents.greatest - extents.least);
  return LinearConstraints{limits.normals, limits.bounds};
}

}  // namespace

absl::StatusOr<ParameterDomain> DomainOf(const templates::Template& design_template) {
  const std::vector<parametric::Parameter>& parameters = design_template.parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  ParameterDomain domain;
  domain.lower.resize(count);
  domain.upper.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    domain.lower[i] = parameters[static_cast<std::size_t>(i)].minimum;
    domain.upper[i] = parameters[static_cast<std::size_t>(i)].maximum;
    domain.whole.push_back(parametric::IsWhole(parameters[static_cast<std::size_t>(i)]));
  }
  MORTISE_ASSIGN_OR_RETURN(domain.cuts,
                           CutsOf(design_template, BoxConstraints(domain.lower, domain.upper)));
  return domain;
}

const absl::StatusOr<ParameterDomain>& KeptDomain::Get() const {
  std::call_once(found_, [this] { domain_ = DomainOf(*design_template_); });
  return domain_;
}

}  // namespace mortise::retrieval
