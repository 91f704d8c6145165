// Custom metrics to and from mortise/v1/metric.proto.
#pragma once

#include "common/base/field_violations.h"
#include "common/expressions/metric_expressions.h"
#include "mortise/v1/metric.pb.h"
#include "mortise/v1/template.pb.h"

namespace mortise::parametric {

MetricDefinitions FromProto(const v1::MetricDefinitions& message);

// Return those of a template, which CAD templates and cages have among what they are made of.
const v1::MetricDefinitions& MetricDefinitionsOf(const v1::Template& message);

// Returns what is wrong with the definitions of a template or request, as MetricExpressions finds
// it, with places below "metric_definitions".
std::vector<FieldViolation> ValidateMetricDefinitions(const v1::MetricDefinitions& message,
                                                      const std::vector<NamedUnit>& parameters,
                                                      const std::vector<NamedUnit>& metrics);

}  // namespace mortise::parametric
