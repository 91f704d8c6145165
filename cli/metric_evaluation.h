// Metrics of a template at parameters, for `mortise analyze TEMPLATE --metric NAME`.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/gateway_client.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::cli {

// Evaluates `metrics`, which may be among `definitions`, at the defaults but for `parameters`.
// INVALID_ARGUMENT naming "parameters[i]" for one that the template does not have, else as the
// evaluator fails.
absl::StatusOr<v1::EvaluationResult> EvaluateMetrics(
    const std::string& subject, const std::vector<v1::ParameterValue>& parameters,
    const std::vector<std::string>& metrics, const v1::MetricDefinitions& definitions,
    const v1::MeshSettings& mesh, const v1::AirflowSettings& airflow, const GatewayClient& client);

}  // namespace mortise::cli
