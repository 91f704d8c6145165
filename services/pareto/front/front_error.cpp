// Newton's method on the squared distance from the reference point of Eq. 7.8.
#include "services/pareto/front/front_error.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "services/pareto/models/bounded_quadratic.h"
#include "services/pareto/models/first_order_expansion.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kIterations = 60;
constexpr double kDifference = 1e-6;    // unit coordinates
constexpr double kMinDecrease = 1e-17;  // of the squared distance: 1e-15 of the error

// Scaled performance over the unit box.
class ScaledProblem {
 public:
  ScaledProblem(const DesignSpace& space, const Scaling& scaling,
                const std::function<Evaluation(const VectorXd&)>& evaluate)
      : space_(space), scaling_(scaling), evaluate_(evaluate) {}

  // Performance with its Jacobian; nullopt where there is none.
  std::optional<std::pair<VectorXd, MatrixXd>> At(const VectorXd& u) const {
    const Evaluation evaluation = evaluate_(DesignOf(u));
    if (evaluation.status != EvaluationStatus::kEvaluated || !evaluation.metrics.allFinite() ||
        evaluation.jacobian.size() == 0 || !evaluation.jacobian.allFinite()) {
      return std::nullopt;
    }
    return std::pair(scaling_.Apply(evaluation.metrics),
                     MatrixXd(scaling_.range.cwiseInverse().asDiagonal() * evaluation.jacobian *
                              (space_.upper - space_.lower).asDiagonal()));
  }

  VectorXd DesignOf(const VectorXd& u) const {
    return (space_.lower + u.cwiseProduct(space_.upper - space_.lower))
        .cwiseMax(space_.lower)
        .cwiseMin(space_.upper);
  }

 private:
  const DesignSpace& space_;
  const Scaling& scaling_;
  const std::function<Evaluation(const VectorXd&)>& evaluate_;
};

// |F(u) - z|^2 / 2 with its slope.
struct Distance {
  double value = std::numeric_limits<double>::infinity();
  VectorXd gradient;
};

Distance DistanceAt(const ScaledProblem& problem, const VectorXd& z, const VectorXd& u) {
  const auto found = problem.At(u);
  if (!found) return {};
  const VectorXd residual = found->first - z;
  return {0.5 * residual.squaredNorm(), found->second.transpose() * residual};
}

// Columns of parameters that are fixed, or cannot be differentiated, are 0.
MatrixXd HessianAt(const ScaledProblem& problem, const VectorXd& z, const VectorXd& u) {
  MatrixXd hessian = MatrixXd::Zero(u.size(), u.size());
  for (Index i = 0; i < u.size(); ++i) {
    VectorXd up = u, down = u;
    up[i] = std::min(u[i] + kDifference, 1.0);
    down[i] = std::max(u[i] - kDifference, 0.0);
    const Distance above = DistanceAt(problem, z, up), below = DistanceAt(problem, z, down);
    if (above.gradient.size() > 0 && below.gradient.size() > 0) {
      hessian.col(i) = (above.gradient - below.gradient) / (up[i] - down[i]);
    }
  }
  return 0.5 * (hessian + hessian.transpose());
}

VectorXd Nearest(const ScaledProblem& problem, const VectorXd& z, VectorXd u) {
  Distance here = DistanceAt(problem, z, u);
  MatrixXd hessian = HessianAt(problem, z, u);
  double radius = 0.1;
  for (int iteration = 0; iteration < kIterations && radius > 1e-12; ++iteration) {
    const VectorXd step = MinimizeBoundedQuadratic(here.gradient, hessian, (-u).cwiseMax(-radius),
                                                   (VectorXd::Ones(u.size()) - u).cwiseMin(radius));
    const double predicted = -(here.gradient.dot(step) + 0.5 * step.dot(hessian * step));
    if (!(predicted > kMinDecrease)) break;
    const VectorXd moved = (u + step).cwiseMax(0.0).cwiseMin(1.0);
    Distance there = DistanceAt(problem, z, moved);
    const double decrease = here.value - there.value;
    if (decrease < 0.25 * predicted) radius = 0.25 * step.cwiseAbs().maxCoeff();
    if (decrease > 0.75 * predicted) radius = std::min(1.0, 2 * radius);
    if (!(decrease > 0)) continue;
    u = moved;
    here = std::move(there);
    hessian = HessianAt(problem, z, u);
  }
  return u;
}

}  // namespace

PushedDesign PushAlongNormal(const DesignSpace& space, const Scaling& scaling,
                             const std::function<Evaluation(const VectorXd&)>& evaluate,
                             const VectorXd& x, double delta_n) {
  const ScaledProblem problem(space, scaling, evaluate);
  const VectorXd u = space.ToUnit(x);
  const auto start = problem.At(u);
  if (!start) return {x, evaluate(x).metrics, std::numeric_limits<double>::quiet_NaN()};
  const auto& [performance, jacobian] = *start;
  const VectorXd z = performance - delta_n * RecoverDuals(jacobian, u).alpha.normalized();
  const VectorXd moved = Nearest(problem, z, u);
  const VectorXd pushed = problem.DesignOf(moved);
  const VectorXd metrics = evaluate(pushed).metrics;
  return {pushed, metrics, delta_n - (scaling.Apply(metrics) - z).norm()};
}

std::vector<double> FrontErrors(const DesignSpace& space, const Front& front,
                                const std::function<Evaluation(const VectorXd&)>& evaluate,
                                double delta_n) {
  std::vector<double> errors;
  for (const FrontPoint& point : front.points) {
    errors.push_back(PushAlongNormal(space, front.scaling, evaluate, point.x, delta_n).error);
  }
  return errors;
}

}  // namespace mortise::pareto
