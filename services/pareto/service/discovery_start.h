// What a discovery takes over from earlier fronts: settled once, when it is asked for, and kept
// with it, so that nothing that happens to those fronts later changes a run that is resumed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/pareto/service/discovery_problem.h"

namespace mortise::v1 {
class DiscoverySpecification;
class Front;
}  // namespace mortise::v1

namespace mortise::pareto {

inline constexpr char kStartKind[] = "discoveryStarts";  // records: the start by operation id

// Returns the start from `fronts`, those that `specification.start_from` names, in its order: a
// message with the parameter names and points of designs (warm_start.h), each with the metrics it
// had where these should be the same now. `specification` has its revision settled.
// INVALID_ARGUMENT naming "specification.start_from[i]" for a front without points or without a
// parameter of `problem`.
absl::StatusOr<v1::Front> SettleStart(const v1::DiscoverySpecification& specification,
                                      const DiscoveryProblem& problem,
                                      const std::vector<v1::Front>& fronts);

// Its designs, D x n.
Eigen::MatrixXd DesignsOf(const v1::Front& start);

// Returns a remark for each metric that is not what it was at the designs of the start: the
// evaluator changed its answers.
std::vector<std::string> ChangedAnswers(const v1::Front& start, const DiscoveryProblem& problem,
                                        const Archive& archive);

}  // namespace mortise::pareto
