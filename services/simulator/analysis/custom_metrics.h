// Computes custom metrics on a design that is analysed.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/metric_expressions.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

class CustomMetrics {
 public:
  using ValueOf = std::function<absl::StatusOr<double>(const std::string& metric)>;

  // Computes all that those of `own` among `names` need; `value_of` gives metrics that are computed
  // otherwise. `own` must outlive it.
  CustomMetrics(const parametric::MetricExpressions& own, const Eigen::VectorXd& parameters,
                const std::vector<std::string>& names, const DesignModel& model,
                const DesignAnalysis& analysis, const ValueOf& value_of);

  // Returns one of `own` among `names`. INVALID_ARGUMENT naming the expression and what it lacks;
  // where a metric fails that it needs, as that.
  absl::StatusOr<Metric> Compute(const std::string& name) const;

  // Returns its gradient by the chain rule from those that are known, by metric or ToText of the
  // call; nothing if one is missing that it needs, or it has none here, as at the root of 0.
  std::optional<Eigen::VectorXd> Gradient(
      const std::string& name, const std::map<std::string, Eigen::VectorXd>& known) const;

 private:
  const parametric::MetricExpressions& own_;
  const Eigen::VectorXd parameters_;
  parametric::MetricExpressions::Needs needs_;
  std::vector<absl::StatusOr<parametric::Dual>> metrics_;
  std::vector<absl::StatusOr<parametric::Dual>> calls_;
};

}  // namespace mortise::simulator
