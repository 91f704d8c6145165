#include "services/simulator/service/evaluation_subject.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "services/simulator/analysis/design_analysis.h"
#include "services/simulator/analysis/design_fields.h"
#include "services/simulator/service/evaluator_records.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/worker/subject_metrics.h"
#include "services/simulator/worker/template_model.h"

namespace mortise::simulator {
namespace {

using MetricDescriptionMessage = v1::DesignSpace::MetricDescription;

bool OffersGradient(const EvaluatedTemplate& compiled, const std::string& metric,
                    const parametric::MetricExpressions& own) {
  if (!HasGradient(metric, own)) return false;
  const MetricDemands demands = DemandsOf({metric}, own);
  if (demands.loads) return compiled.gradients.loads;
  return demands.surface ? compiled.gradients.shape : compiled.gradients.mass;
}

EvaluationSubject SubjectOf(const EvaluatedTemplate& compiled,
                            const parametric::MetricExpressions& own) {
  EvaluationSubject subject{.digest = compiled.digest, .queue = kSimulatorQueue};
  v1::DesignSpace& space = subject.space;
  space.set_subject(compiled.name);
  space.set_revision(compiled.revision);
  for (const parametric::Parameter& parameter : compiled.design_template->parameters()) {
    auto* described = space.add_parameters();
    described->set_name(parameter.name);
    described->set_unit(parameter.unit);
    described->set_minimum(parameter.minimum);
    described->set_maximum(parameter.maximum);
    described->set_default_value(parameter.default_value);
    described->set_step(parameter.step);
    for (const std::string& choice : parameter.choices) described->add_choices(choice);
  }
  for (const MetricDescription& metric : MetricsOf(*compiled.design_template)) {
    if (own.Find(metric.name) >= 0) continue;  // an older template's own of this name
    auto* described = space.add_metrics();
    described->set_name(metric.name);
    described->set_unit(metric.unit);
    described->set_description(metric.description);
    described->set_offers_gradient(OffersGradient(compiled, metric.name, own));
  }
  for (const parametric::MetricDefinition& metric : own.metrics()) {
    auto* described = space.add_metrics();
    described->set_name(metric.name);
    described->set_unit(metric.unit);
    described->set_description(metric.description.empty() ? metric.expression : metric.description);
    described->set_offers_gradient(OffersGradient(compiled, metric.name, own));
  }
  space.set_geometry(v1::TETRAHEDRA);
  for (const FieldDescription& field : OfferedFields()) {
    auto* described = space.add_fields();
    described->set_name(field.name);
    described->set_unit(field.unit);
    described->set_components(field.components);
    described->set_of_elements(field.of_elements);
    described->set_description(field.description);
  }
  return subject;
}

absl::StatusOr<EvaluationSubject> FindRegistered(store::Store& store, const std::string& name,
                                                 int64_t revision) {
  EvaluationSubject subject{.queue = name};
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& read) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const v1::Evaluator evaluator, kEvaluators.Get(read, name, "subject"));
    subject.space = evaluator.space();
    subject.digest = EvaluatorDigest(evaluator);
    return absl::OkStatus();
  }));
  if (revision == 0 || revision == subject.space.revision()) return subject;
  return ResourceNotFound(absl::StrCat(name, "/revisions/", revision));
}

const MetricDescriptionMessage* FindMetric(const v1::DesignSpace& space, const std::string& name) {
  for (const MetricDescriptionMessage& metric : space.metrics()) {
    if (metric.name() == name) return &metric;
  }
  return nullptr;
}

absl::Status CheckGradients(const v1::Task& task, const v1::DesignSpace& space,
                            const v1::EvaluationResult& result) {
  std::vector<std::string> expected;
  for (const std::string& name : task.metrics()) {
    const MetricDescriptionMessage* const metric = FindMetric(space, name);
    if (task.gradients() && metric != nullptr && metric->offers_gradient()) {
      expected.push_back(name);
    }
  }
  if (result.gradients_size() != static_cast<int>(expected.size())) {
    return InvalidField("result.gradients",
                        absl::StrCat("has ", result.gradients_size(), " entries; asked for were ",
                                     expected.size(), ": ", absl::StrJoin(expected, ", ")));
  }
  for (int i = 0; i < result.gradients_size(); ++i) {
    const std::string field = absl::StrCat("result.gradients[", i, "]");
    if (result.gradients(i).metric() != expected[i]) {
      return InvalidField(field + ".metric", absl::StrCat("must be '", expected[i], "'"));
    }
    if (result.gradients(i).values_size() == space.parameters_size()) continue;
    return InvalidField(
        field + ".values",
        absl::StrCat("has ", result.gradients(i).values_size(), " entries, one for each of the ",
                     space.parameters_size(), " parameters is needed"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<EvaluationSubject> FindSubject(SimulatorCore& core, const std::string& name,
                                              int64_t revision,
                                              const v1::MetricDefinitions& definitions,
                                              const rpc::Origin& origin) {
  if (IsEvaluatorName(name)) {
    if (!DefinitionsText(definitions).empty()) {
      return InvalidField("metric_definitions",
                          "are for templates: an evaluator of one's own computes its own metrics");
    }
    return FindRegistered(*core.store(), name, revision);
  }
  MORTISE_ASSIGN_OR_RETURN(const auto compiled, core.templates().Get(name, revision, origin));
  MORTISE_ASSIGN_OR_RETURN(const parametric::MetricExpressions own,
                           CustomMetricsOf(*compiled, definitions));
  return SubjectOf(*compiled, own);
}

absl::Status CheckMetrics(const v1::DesignSpace& space, const std::vector<std::string>& metrics) {
  if (metrics.empty()) return InvalidField("metrics", "ask for at least one metric");
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (FindMetric(space, metrics[i]) != nullptr) continue;
    const std::string offered = absl::StrJoin(
        space.metrics(), ", ", [](std::string* out, const MetricDescriptionMessage& metric) {
          out->append(metric.name());
        });
    return InvalidField(absl::StrCat("metrics[", i, "]"),
                        absl::StrCat("'", metrics[i], "' is not offered; there are ", offered));
  }
  return absl::OkStatus();
}

absl::Status CheckPoint(const v1::DesignSpace& space, const v1::DesignPoint& point,
                        const std::string& field) {
  if (point.parameters_size() != space.parameters_size()) {
    return InvalidField(field + ".parameters", absl::StrCat("must be ", space.parameters_size(),
                                                            " values, one for each parameter"));
  }
  for (int k = 0; k < space.parameters_size(); ++k) {
    const v1::DesignSpace::DesignParameter& parameter = space.parameters(k);
    const double slack = 1e-9 * (parameter.maximum() - parameter.minimum());
    const double value = point.parameters(k);
    const bool is_within =
        value >= parameter.minimum() - slack && value <= parameter.maximum() + slack;
    if (is_within && (parameter.choices().empty() || value == std::round(value))) continue;
    if (!parameter.choices().empty()) {
      return InvalidField(absl::StrCat(field, ".parameters[", k, "]"),
                          absl::StrCat(parameter.name(), " must be the number of a choice, 0 to ",
                                       parameter.choices_size() - 1, ": ",
                                       absl::StrJoin(parameter.choices(), ", ")));
    }
    return InvalidField(absl::StrCat(field, ".parameters[", k, "]"),
                        absl::StrCat(parameter.name(), " must be within ", parameter.minimum(),
                                     " to ", parameter.maximum()));
  }
  return absl::OkStatus();
}

absl::Status CompleteResult(const v1::Task& task, const v1::DesignSpace& space,
                            v1::EvaluationResult& result) {
  if (result.metrics_size() != task.metrics_size()) {
    return InvalidField(
        "result.metrics",
        absl::StrCat("has ", result.metrics_size(), " entries; asked for were ",
                     task.metrics_size(), ": ", absl::StrJoin(task.metrics(), ", ")));
  }
  for (int i = 0; i < result.metrics_size(); ++i) {
    v1::Metric& metric = *result.mutable_metrics(i);
    const std::string field = absl::StrCat("result.metrics[", i, "]");
    if (metric.name() != task.metrics(i)) {
      return InvalidField(field + ".name", absl::StrCat("must be '", task.metrics(i), "'"));
    }
    const MetricDescriptionMessage* const offered = FindMetric(space, metric.name());
    if (offered == nullptr) continue;
    if (metric.unit().empty()) metric.set_unit(offered->unit());
    if (metric.unit() == offered->unit()) continue;
    return InvalidField(field + ".unit", absl::StrCat("must be '", offered->unit(), "'"));
  }
  return CheckGradients(task, space, result);
}

std::string WhatIsNotFinite(const v1::EvaluationResult& result) {
  std::vector<std::string> found;
  for (const v1::Metric& metric : result.metrics()) {
    if (!std::isfinite(metric.value())) found.push_back(metric.name());
  }
  for (const v1::Gradient& gradient : result.gradients()) {
    if (!std::ranges::all_of(gradient.values(),
                             [](double value) { return std::isfinite(value); })) {
      found.push_back(absl::StrCat("the gradient of ", gradient.metric()));
    }
  }
  return absl::StrJoin(found, ", ");
}

}  // namespace mortise::simulator
