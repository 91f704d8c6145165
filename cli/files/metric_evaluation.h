// Asks evaluators: what can be varied, and the metrics of a design, as for `mortise analyze
// TEMPLATE
// --metric NAME`.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::cli {

struct EvaluatedMetrics {
  v1::DesignSpace space;
  v1::EvaluationResult result;
};

// Returns what can be varied and asked of a subject. Fails as the evaluator does.
absl::StatusOr<v1::DesignSpace> DescribeDesignSpace(const v1::DescribeDesignSpaceRequest& request,
                                                    const GatewayClient& client);

// Evaluates what `asked` says (revision, metrics, gradients, settings) of a subject at the defaults
// but for `parameters`. INVALID_ARGUMENT naming "parameters[i]" for one that the template does not
// have, else as the evaluator fails.
absl::StatusOr<EvaluatedMetrics> EvaluateMetrics(const std::string& subject,
                                                 const std::vector<v1::ParameterValue>& parameters,
                                                 const v1::EvaluateBatchRequest& asked,
                                                 const GatewayClient& client);

}  // namespace mortise::cli
