// From what a client asks for to what discovery works on.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/pareto/discovery/discovery.h"
#include "services/pareto/discovery/robust_evaluator.h"
#include "services/pareto/models/combinations.h"
#include "services/pareto/service/discovery_constraints.h"

namespace mortise::v1 {
class DesignSpace;
class DiscoverySpecification;
}  // namespace mortise::v1

namespace mortise::pareto {

struct Objective {
  std::string metric;
  std::string unit;
  bool maximize = false;
  bool offers_gradient = false;
};

struct DiscoveryProblem {
  DesignSpace space;  // in the order of parameter_names, bounds narrowed as asked
  std::vector<std::string> parameter_names;
  // Of each parameter the names of its values 0, 1, ...; none of a number.
  std::vector<std::vector<std::string>> choices;
  std::vector<DiscreteParameter> discrete;  // choices, and whole numbers of few values
  Eigen::VectorXd default_design;           // the subject's own, whatever the bounds asked for
  std::vector<Objective> objectives;        // 2 to 6
  std::vector<Constraint> constraints;
  Robustness robustness;       // without tolerances where metrics count as they are
  Discovery::Options options;  // `evaluations` are designs

  // +1 for a metric to minimise, -1 to maximise: discovery minimises sign * metric. d.
  Eigen::VectorXd Signs() const;
  bool AnyGradient() const;
  bool AllGradients() const;
};

// Checks what needs no evaluator: counts, ranges, names given twice. INVALID_ARGUMENT naming the
// field ("specification.evaluations").
absl::Status CheckSpecification(const v1::DiscoverySpecification& specification);

// Returns the problem for a subject as its evaluator describes it. INVALID_ARGUMENT naming the
// field at fault
// ("specification.objectives[1].metric" for an unknown metric, "specification.bounds[0].minimum"
// for one outside the design space, "specification.bounds[0].choices[1]" for an unknown choice,
// "specification.subject" for a design space that is unusable).
absl::StatusOr<DiscoveryProblem> MakeProblem(const v1::DiscoverySpecification& specification,
                                             const v1::DesignSpace& described);

}  // namespace mortise::pareto
