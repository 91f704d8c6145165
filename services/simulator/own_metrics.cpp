#include "services/simulator/own_metrics.h"

#include <algorithm>
#include <iterator>

#include "common/base/errors.h"
#include "services/simulator/place_functions.h"

namespace mortise::simulator {
namespace {

using parametric::Dual;

absl::StatusOr<Dual> WithoutGradient(const absl::StatusOr<double>& value) {
  if (!value.ok()) return value.status();
  return Dual{*value, {}};
}

}  // namespace

OwnMetrics::OwnMetrics(const parametric::MetricExpressions& own, const Eigen::VectorXd& parameters,
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

absl::StatusOr<Metric> OwnMetrics::Compute(const std::string& name) const {
  const int index = own_.Find(name);
  MORTISE_ASSIGN_OR_RETURN(const Dual value,
                           own_.At(index, parameters_, false, needs_, metrics_, calls_));
  return Metric{name, own_.metrics()[static_cast<std::size_t>(index)].unit, value.value};
}

}  // namespace mortise::simulator
