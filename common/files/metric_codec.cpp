#include "common/files/metric_codec.h"

namespace mortise::parametric {

MetricDefinitions FromProto(const v1::MetricDefinitions& message) {
  MetricDefinitions definitions;
  for (const v1::MetricExpression& metric : message.expressions()) {
    definitions.expressions.push_back(
        {metric.name(), metric.unit(), metric.expression(), metric.description()});
  }
  for (const v1::NamedPoint& point : message.points()) {
    definitions.points.push_back({point.name(), point.x(), point.y(), point.z()});
  }
  return definitions;
}

const v1::MetricDefinitions& MetricDefinitionsOf(const v1::Template& message) {
  if (message.has_cad()) return message.cad().metric_definitions();
  if (message.has_cage()) return message.cage().metric_definitions();
  return message.metric_definitions();
}

std::vector<FieldViolation> ValidateMetricDefinitions(const v1::MetricDefinitions& message,
                                                      const std::vector<NamedUnit>& parameters,
                                                      const std::vector<NamedUnit>& metrics) {
  std::vector<FieldViolation> findings;
  const MetricExpressions expressions(FromProto(message), {}, parameters, metrics,
                                      "metric_definitions", findings);
  return findings;
}

}  // namespace mortise::parametric
