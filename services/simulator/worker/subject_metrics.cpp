#include "services/simulator/worker/subject_metrics.h"

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/files/metric_codec.h"
#include "services/simulator/worker/template_model.h"

namespace mortise::simulator {

absl::StatusOr<parametric::MetricExpressions> CustomMetricsOf(const EvaluatedTemplate& compiled,
                                                              const v1::MetricDefinitions& asked) {
  const parametric::MetricDefinitions definitions = parametric::FromProto(asked);
  if (definitions.IsEmpty() && compiled.metrics.IsEmpty()) return parametric::MetricExpressions();
  std::vector<parametric::NamedUnit> parameters;
  for (const parametric::Parameter& parameter : compiled.design_template->parameters()) {
    parameters.push_back({parameter.name, parameter.unit, parameter.choices});
  }
  std::vector<FieldViolation> findings;
  parametric::MetricExpressions expressions(definitions, compiled.metrics, parameters,
                                            UnitsOf(MetricsOf(*compiled.design_template)),
                                            "metric_definitions", findings);
  const absl::Status status = parametric::ToStatus(findings);
  if (!status.ok()) return status;
  return expressions;
}

std::string DefinitionsText(const v1::MetricDefinitions& asked) {
  if (asked.expressions_size() == 0 && asked.points_size() == 0) return "";
  return absl::StrCat(" with ", Sha256Hex(asked.SerializeAsString()));
}

}  // namespace mortise::simulator
