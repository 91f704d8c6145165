#include "services/simulator/analysis/custom_metrics.h"

#include <algorithm>
#include <iterator>

#include "common/base/errors.h"
#include "services/simulator/analysis/place_functions.h"

namespace mortise::simulator {
namespace {

using parametric::Dual;

absl::StatusOr<Dual> WithoutGradient(const absl::StatusOr<double>& value) {
  if (!value.ok()) return value.status();
  return Dual{*value, {}};
}

}  // namespace

CustomMetrics::CustomMetrics(const parametric::MetricExpressions& own,
                             const Eigen::VectorXd& parameters,
                             const std::vector<std::string>& names, const DesignModel& model,
                             const DesignAnalysis& analysis, const ValueOf& value_of)
    : own_(own), parameters_(parameters) {
  std::vector<std::string> asked;
  std::copy_if(names.begin(), names.end(), std::back_inserter(asked),
               [&own](const std::string& name) { return own.Find(name) >= 0; });
  needs_ = own.NeedsOf(asked);
  for (const std::string& metric : needs_.metrics) {
    metrics_.push_back(WithoutGradient(value_of(metric)));
  }
  const PlaceFunctions places(own_, parameters_, model, analysis);
  for (const parametric::MetricCall& call : needs_.calls) {
    calls_.push_back(WithoutGradient(places.Value(call)));
  }
}

absl::StatusOr<Metric> CustomMetrics::Compute(const std::string& name) const {
  const int index = own_.Find(name);
  MORTISE_ASSIGN_OR_RETURN(const Dual value,
                           own_.At(index, parameters_, false, needs_, metrics_, calls_));
  return Metric{name, own_.metrics()[static_cast<std::size_t>(index)].unit, value.value};
}

std::optional<Eigen::VectorXd> CustomMetrics::Gradient(
    const std::string& name, const std::map<std::string, Eigen::VectorXd>& known) const {
  // What it does not need may lack a gradient: that stays without one, and nobody looks.
  const auto needs = own_.NeedsOf(std::span(&name, 1));
  const auto with_gradient = [&](const auto& terms, const auto& values, const auto& wanted,
                                 const auto& text_of,
                                 std::vector<absl::StatusOr<Dual>>& completed) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      completed.push_back(values[i]);
      if (std::find(wanted.begin(), wanted.end(), terms[i]) == wanted.end()) continue;
      const auto gradient = known.find(text_of(terms[i]));
      if (gradient == known.end() || !values[i].ok()) return false;
      completed.back()->gradient = gradient->second;
    }
    return true;
  };
  std::vector<absl::StatusOr<Dual>> metrics, calls;
  if (!with_gradient(
          needs_.metrics, metrics_, needs.metrics, [](const std::string& metric) { return metric; },
          metrics) ||
      !with_gradient(
          needs_.calls, calls_, needs.calls,
          [](const parametric::MetricCall& call) { return ToText(call); }, calls)) {
    return std::nullopt;
  }
  auto value = own_.At(own_.Find(name), parameters_, true, needs_, metrics, calls);
  if (!value.ok()) return std::nullopt;
  return std::move(value->gradient);
}

}  // namespace mortise::simulator
