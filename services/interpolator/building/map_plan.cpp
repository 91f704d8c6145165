#include "services/interpolator/building/map_plan.h"

#include <algorithm>

namespace mortise::interpolator {

std::vector<std::size_t> MapPlan::NumberParameters() const {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!parameters[i].whole) numbers.push_back(i);
  }
  return numbers;
}

std::vector<std::size_t> MapPlan::WholeParameters() const {
  std::vector<std::size_t> wholes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].whole) wholes.push_back(i);
  }
  return wholes;
}

Eigen::VectorXd MapPlan::DesignAt(Eigen::Index structure, const Eigen::VectorXd& u) const {
  Eigen::VectorXd design = base;
  Eigen::Index number = 0, whole = 0;
  for (const PlannedParameter& parameter : parameters) {
    if (parameter.whole) {
      design[parameter.index] = structures(whole++, structure);
    } else {
      // An end of the range exactly, whatever rounding says.
      const double t = u[number++];
      design[parameter.index] = std::clamp((1 - t) * parameter.minimum + t * parameter.maximum,
                                           parameter.minimum, parameter.maximum);
    }
  }
  return design;
}

Eigen::VectorXd MapPlan::DesignOf(const Eigen::VectorXd& point) const {
  Eigen::VectorXd design = base;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    design[parameters[i].index] = point[static_cast<Eigen::Index>(i)];
  }
  return design;
}

Eigen::VectorXd MapPlan::PointOf(const Eigen::VectorXd& design) const {
  Eigen::VectorXd point(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    point[static_cast<Eigen::Index>(i)] = design[parameters[i].index];
  }
  return point;
}

}  // namespace mortise::interpolator
