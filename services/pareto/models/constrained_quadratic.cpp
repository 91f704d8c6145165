#include "services/pareto/models/constrained_quadratic.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr int kMaxEvaluations = 200;  // of the quadratics
constexpr double kTolerance = 1e-9;   // of a step, relative
constexpr double kShortness = 1e-6;   // weight of a step's length beside violations
constexpr double kInside = 1e-7;      // how far inside of constraints steps are to end
constexpr double kSlack = 5e-8;       // what rounding may take of that
constexpr int kHalvings = 30;

using Optimizer = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;
using Function = double (*)(unsigned n, const double* p, double* gradient, void* data);

VectorXd Vector(unsigned n, const double* p) {
  return VectorXd::Map(p, static_cast<Eigen::Index>(n));
}

void Give(const VectorXd& values, double* to) {
  if (to != nullptr) std::ranges::copy(values, to);
}

double Quadratic(unsigned n, const double* p, double* gradient, void* data) {
  const auto& function = *static_cast<const QuadraticFunction*>(data);
  const VectorXd at = Vector(n, p);
  Give(function.gradient + function.hessian * at, gradient);
  return function(at);
}

double SquaredViolation(unsigned n, const double* p, double* gradient, void* data) {
  const auto& constraints = *static_cast<const std::vector<QuadraticFunction>*>(data);
  const VectorXd at = Vector(n, p);
  VectorXd slope = kShortness * at;
  double sum = 0.5 * kShortness * at.squaredNorm();
  for (const QuadraticFunction& constraint : constraints) {
    const double above = std::max(0.0, constraint(at));
    sum += 0.5 * above * above;
    if (above > 0) slope += above * (constraint.gradient + constraint.hessian * at);
  }
  Give(slope, gradient);
  return sum;
}

Optimizer MakeOptimizer(Function objective, void* data, const VectorXd& lower,
                        const VectorXd& upper) {
  Optimizer optimizer(nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(lower.size())),
                      &nlopt_destroy);
  nlopt_set_min_objective(optimizer.get(), objective, data);
  nlopt_set_lower_bounds(optimizer.get(), lower.data());
  nlopt_set_upper_bounds(optimizer.get(), upper.data());
  nlopt_set_xtol_rel(optimizer.get(), kTolerance);
  nlopt_set_maxeval(optimizer.get(), kMaxEvaluations);
  return optimizer;
}

// From 0. Wherever it ends is within the box; what it is worth is for the caller to see.
VectorXd Minimum(const Optimizer& optimizer, const VectorXd& lower, const VectorXd& upper) {
  VectorXd p = VectorXd::Zero(lower.size());
  double value = 0;
  nlopt_optimize(optimizer.get(), p.data(), &value);
  if (!p.allFinite()) return VectorXd::Zero(lower.size());
  return p.cwiseMax(lower).cwiseMin(upper);
}

}  // namespace

double Violation(const std::vector<QuadraticFunction>& constraints, const VectorXd& p) {
  double sum = 0;
  for (const QuadraticFunction& constraint : constraints) {
    sum += std::pow(std::max(0.0, constraint(p)), 2);
  }
  return std::sqrt(sum);
}

VectorXd MinimizeWithin(const QuadraticFunction& objective,
                        const std::vector<QuadraticFunction>& constraints, const VectorXd& lower,
                        const VectorXd& upper) {
  QuadraticFunction minimized = objective;
  std::vector<QuadraticFunction> kept = constraints;
  for (QuadraticFunction& constraint : kept) {
    constraint.value = std::min(constraint.value + kInside, 0.0);
  }
  const Optimizer optimizer = MakeOptimizer(Quadratic, &minimized, lower, upper);
  for (QuadraticFunction& constraint : kept) {
    nlopt_add_inequality_constraint(optimizer.get(), Quadratic, &constraint, kSlack);
  }
  VectorXd p = Minimum(optimizer, lower, upper);
  const auto keeps = [&] {
    return std::ranges::all_of(
        kept, [&](const QuadraticFunction& constraint) { return constraint(p) <= kSlack; });
  };
  for (int halving = 0; halving < kHalvings && !keeps(); ++halving) p *= 0.5;
  return keeps() && objective(p) < objective.value ? p : VectorXd::Zero(p.size());
}

VectorXd ReduceViolation(const std::vector<QuadraticFunction>& constraints, const VectorXd& lower,
                         const VectorXd& upper) {
  std::vector<QuadraticFunction> reduced = constraints;
  const Optimizer optimizer = MakeOptimizer(SquaredViolation, &reduced, lower, upper);
  const VectorXd p = Minimum(optimizer, lower, upper);
  const VectorXd none = VectorXd::Zero(p.size());
  return Violation(constraints, p) < Violation(constraints, none) ? p : none;
}

}  // namespace mortise::pareto
