// How the formulas of benchmark problems become evaluations: values, and slopes by forward
// differentiation of the same formulas. For the files of benchmark problems only.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <unsupported/Eigen/AutoDiff>
#include <vector>

#include "services/pareto/archive/evaluation.h"

namespace mortise::pareto {

using Dual = Eigen::AutoDiffScalar<Eigen::VectorXd>;

template <typename T>
using Vector = std::vector<T>;

inline double Root(double value) { return std::sqrt(value); }

// The slope of the root is infinite at 0, but only along coordinates that move its argument.
inline Dual Root(const Dual& value) {
  if (value.value() > 0) return Dual(sqrt(value));
  Dual root(0, value.derivatives());
  for (double& slope : root.derivatives()) {
    if (slope != 0) slope = std::copysign(std::numeric_limits<double>::infinity(), slope);
  }
  return root;
}

inline double NumberOf(double value) { return value; }
inline double NumberOf(const Dual& value) { return value.value(); }

// `formula` gives d metrics, and then constraints.
template <typename Formula>
std::function<Evaluation(const Eigen::VectorXd&, bool)> Evaluating(Formula formula,
                                                                   Eigen::Index d) {
  return [formula, d](const Eigen::VectorXd& x, bool gradients) {
    Evaluation evaluation;
    evaluation.x = x;
    evaluation.status = EvaluationStatus::kEvaluated;
    if (!gradients) {
      const auto values = formula(Vector<double>(x.begin(), x.end()));
      const Eigen::VectorXd all =
          Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
      evaluation.metrics = all.head(d);
      evaluation.constraints = all.tail(all.size() - d);
      return evaluation;
    }
    Vector<Dual> duals;
    for (Eigen::Index i = 0; i < x.size(); ++i) duals.emplace_back(x[i], x.size(), i);
    const Vector<Dual> values = formula(duals);
    const auto count = static_cast<Eigen::Index>(values.size());
    Eigen::VectorXd all(count);
    Eigen::MatrixXd jacobian(count, x.size());
    for (Eigen::Index j = 0; j < count; ++j) {
      all[j] = values[static_cast<std::size_t>(j)].value();
      jacobian.row(j) = values[static_cast<std::size_t>(j)].derivatives().transpose();
    }
    evaluation.metrics = all.head(d);
    evaluation.jacobian = jacobian.topRows(d);
    evaluation.constraints = all.tail(count - d);
    if (count > d) evaluation.constraint_jacobian = jacobian.bottomRows(count - d);
    return evaluation;
  };
}

}  // namespace mortise::pareto
