// The metrics of a template: those that every design has, its own, and those of a request.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/metric_expressions.h"
#include "mortise/v1/metric.pb.h"
#include "services/simulator/worker/template_source.h"

namespace mortise::simulator {

// Returns the template's own metrics and those of a request, ready to be computed. INVALID_ARGUMENT
// naming all that is wrong with the request's, below "metric_definitions".
absl::StatusOr<parametric::MetricExpressions> CustomMetricsOf(const EvaluatedTemplate& compiled,
                                                              const v1::MetricDefinitions& asked);

// Returns what tells the definitions of one request from those of another, for caches; empty where
// there are none.
std::string DefinitionsText(const v1::MetricDefinitions& asked);

}  // namespace mortise::simulator
