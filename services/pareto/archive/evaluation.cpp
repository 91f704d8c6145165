// Maps between designs and unit coordinates, and the check of a design space.
#include "services/pareto/archive/evaluation.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {

Eigen::VectorXd DesignSpace::FromUnit(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const double range = upper[i] - lower[i];
    const double increment = step.size() > 0 ? step[i] : 0.0;
    if (increment > 0) {
      const double most = std::floor(range / increment * (1 + 1e-12));
      const double count = std::clamp(std::round(u[i] * range / increment), 0.0, most);
      x[i] = std::min(lower[i] + count * increment, upper[i]);
    } else if (u[i] <= 0) {
      x[i] = lower[i];
    } else if (u[i] >= 1) {
      x[i] = upper[i];
    } else {
      x[i] = std::clamp(lower[i] + u[i] * range, lower[i], upper[i]);
    }
  }
  return x;
}

Eigen::VectorXd DesignSpace::ToUnit(const Eigen::VectorXd& x) const {
  Eigen::VectorXd u(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const double range = upper[i] - lower[i];
    u[i] = range > 0 ? std::clamp((x[i] - lower[i]) / range, 0.0, 1.0) : 0.0;
  }
  return u;
}

Eigen::VectorXd DesignSpace::Nearest(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd set = FromUnit(ToUnit(x));
  Eigen::VectorXd nearest = x.cwiseMax(lower).cwiseMin(upper);
  for (Eigen::Index i = 0; i < size(); ++i) {
    // A value that rounding alone keeps off its step counts as set.
    const bool free = step.size() == 0 || !(step[i] > 0);
    if (!free && std::abs(nearest[i] - set[i]) > 1e-9 * step[i]) nearest[i] = set[i];
  }
  return nearest;
}

absl::Status Validate(const DesignSpace& space, Eigen::Index limit) {
  if (space.size() == 0) return InvalidField("parameters", "at least one parameter is needed");
  if (space.size() > limit) {
    return InvalidField("parameters",
                        absl::StrCat("at most ", limit, " parameters, not ", space.size()));
  }
  if (space.upper.size() != space.size()) {
    return InvalidField("parameters", "as many upper as lower bounds are needed");
  }
  if (space.step.size() != 0 && space.step.size() != space.size()) {
    return InvalidField("parameters", "as many steps as bounds are needed");
  }
  for (Eigen::Index i = 0; i < space.size(); ++i) {
    const std::string field = absl::StrCat("parameters[", i, "]");
    if (!std::isfinite(space.lower[i])) {
      return InvalidField(absl::StrCat(field, ".lower"), "the bound must be a finite number");
    }
    if (!std::isfinite(space.upper[i])) {
      return InvalidField(absl::StrCat(field, ".upper"), "the bound must be a finite number");
    }
    if (space.lower[i] > space.upper[i]) {
      return InvalidField(absl::StrCat(field, ".upper"),
                          absl::StrCat("the upper bound ", space.upper[i],
                                       " lies below the lower bound ", space.lower[i]));
    }
    if (space.step.size() != 0 && !(space.step[i] >= 0 && std::isfinite(space.step[i]))) {
      return InvalidField(absl::StrCat(field, ".step"), "must be a finite number, at least 0");
    }
    if (!std::isfinite(space.upper[i] - space.lower[i])) {
      return InvalidField(absl::StrCat(field, ".upper"), "the range between the bounds overflows");
    }
  }
  return absl::OkStatus();
}

evaluation::FailedDesign FailureOf(const Evaluation& evaluation) {
  if (evaluation.status == EvaluationStatus::kFailed) {
    return {evaluation.reason, evaluation.code, evaluation.message, evaluation.x};
  }
  return {"NOT_FINITE", absl::StatusCode::kInternal,
          evaluation.message.empty() ? "a metric or constraint is not finite" : evaluation.message,
          evaluation.x};
}

bool IsUsable(const Evaluation& evaluation) {
  return evaluation.status == EvaluationStatus::kEvaluated && evaluation.metrics.allFinite() &&
         evaluation.constraints.allFinite();
}

absl::Status CheckAnswer(const Evaluation& evaluation, Eigen::Index parameters,
                         Eigen::Index metrics, Eigen::Index constraints) {
  if (evaluation.status != EvaluationStatus::kEvaluated) return absl::OkStatus();
  if (evaluation.constraints.size() != constraints) {
    return InvalidField("constraints", absl::StrCat(constraints, " are needed, not ",
                                                    evaluation.constraints.size()));
  }
  if (evaluation.constraint_jacobian.size() > 0 &&
      (evaluation.constraint_jacobian.rows() != constraints ||
       evaluation.constraint_jacobian.cols() != parameters)) {
    return InvalidField("constraint_jacobian",
                        "must have a row a constraint and a column a parameter");
  }
  if (evaluation.metrics.size() != metrics) {
    return InvalidField("metrics",
                        absl::StrCat(metrics, " are needed, not ", evaluation.metrics.size()));
  }
  if (evaluation.deviations.size() != 0 && evaluation.deviations.size() != metrics) {
    return InvalidField("deviations", "must be as many as metrics");
  }
  if (evaluation.jacobian.size() > 0 &&
      (evaluation.jacobian.rows() != metrics || evaluation.jacobian.cols() != parameters)) {
    return InvalidField("jacobian", "must have a row a metric and a column a parameter");
  }
  return absl::OkStatus();
}

}  // namespace mortise::pareto
