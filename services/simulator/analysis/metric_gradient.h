// Says how a metric changes with the parameters.
#pragma once

#include <Eigen/Core>
#include <string>

namespace mortise::simulator {

// The gradient of a metric with respect to all parameters.
struct MetricGradient {
  std::string metric;
  Eigen::VectorXd values;  // metric unit per parameter unit
};

}  // namespace mortise::simulator
