#include "services/pareto/front_polishing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "services/pareto/bounded_quadratic.h"
#include "services/pareto/constrained_quadratic.h"
#include "services/pareto/first_order_expansion.h"
#include "services/pareto/quadratic_model.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kBeyond = 1e-2;      // delta_N: how far beyond the front the target is
constexpr double kLeastReach = 1e-3;  // where there are no neighbours
constexpr double kFrontReach = 3;  // of designs of the front, over the distance to their neighbours
constexpr std::size_t kLookedAt = 4;  // designs, for each that is wanted
constexpr double kLeastGain = 2e-6;   // of them: the thesis asks for errors below 1e-5

// The constraints as functions of a step from `u`; none where there are none.
std::vector<QuadraticFunction> ConstraintsNear(const Archive& archive, std::size_t near,
                                               const VectorXd& u, double radius) {
  if (archive[near].constraints.size() == 0) return {};
  return ConstraintsAround(
      FitConstraintModel(archive, near, radius, archive.PriorConstraintJacobian(u)), u,
      archive.ConstraintSizes());
}

// How far to slide along `directions` of the front (D x k) so that performance `from` comes to lie
// on the ray from the ideal through `aim`. `jacobian` (d x D) is scaled.
VectorXd BackToRay(const VectorXd& aim, const VectorXd& from, const MatrixXd& jacobian,
                   const MatrixXd& directions) {
  const VectorXd ray = aim.normalized();
  if (directions.cols() == 0 || !(ray.norm() > 0)) return VectorXd::Zero(jacobian.cols());
  const MatrixXd slopes = jacobian * directions;
  const MatrixXd across = slopes - ray * (ray.transpose() * slopes);
  const VectorXd off = from - ray * ray.dot(from);
  return -directions * across.completeOrthogonalDecomposition().solve(off);
}

// From u to the neighbour number `rank` among the entries.
double DistanceToNeighbour(const Archive& archive, const VectorXd& u,
                           const std::vector<std::size_t>& entries, std::size_t rank) {
  std::vector<double> squares;
  squares.reserve(entries.size());
  for (const std::size_t other : entries) {
    const double square = (archive[other].u - u).squaredNorm();
    if (square > 0) squares.push_back(square);
  }
  if (squares.empty()) return kLeastReach;
  rank = std::min(rank, squares.size()) - 1;
  std::ranges::nth_element(squares, squares.begin() + static_cast<std::ptrdiff_t>(rank));
  return std::sqrt(squares[rank]);
}

}  // namespace

PolishedDesign Polished(const Archive& archive, const Scaling& scaling, const VectorXd& u,
                        double reach) {
  const std::size_t near = archive.Nearest(u, 1).front();
  const double radius = 2 * reach;
  const QuadraticModel model = FitQuadraticModel(archive, near, radius, archive.PriorJacobian(u));
  MatrixXd jacobian = model.jacobian;
  for (Eigen::Index i = 0; i < jacobian.rows(); ++i)
    jacobian.row(i) +=
        (model.hessians[static_cast<std::size_t>(i)] * (u - model.centre)).transpose();
  jacobian = (scaling.range.cwiseInverse().asDiagonal() * jacobian).eval();
  const KktPoint kkt = RecoverDuals(jacobian, u);
  if (kkt.free.empty()) return {u, 0};
  const VectorXd normal = kkt.alpha.normalized();
  const VectorXd residual = kBeyond * normal;
  const QuadraticFunction objective{
      0, jacobian.transpose() * residual,
      jacobian.transpose() * jacobian +
          model.WeightedHessian(residual.cwiseQuotient(scaling.range))};
  VectorXd lower = (-u).cwiseMax(-reach), upper = (1 - u.array()).matrix().cwiseMin(reach);
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (u[i] <= 0 || u[i] >= 1) lower[i] = upper[i] = 0;
  const std::vector<QuadraticFunction> constraints = ConstraintsNear(archive, near, u, radius);
  VectorXd step = MinimizeBoundedQuadratic(objective.gradient, objective.hessian, lower, upper);
  if (Violation(constraints, step) > 0) {
    step = MinimizeWithin(objective, constraints, lower, upper);
  } else {
    const VectorXd aim = scaling.Apply(model.Predict(u));
    const MatrixXd hessian = model.WeightedHessian(kkt.alpha.cwiseQuotient(scaling.range));
    const VectorXd slide = BackToRay(aim, scaling.Apply(model.Predict(u + step)), jacobian,
                                     ExpansionDirections(kkt, jacobian, hessian));
    const VectorXd slid = (step + slide).cwiseMax(lower).cwiseMin(upper);
    if (!(Violation(constraints, slid) > 0)) step = slid;
  }
  if (!step.allFinite()) return {u, 0};
  const VectorXd change = model.Predict(u + step) - model.Predict(u);
  return {(u + step).cwiseMax(0.0).cwiseMin(1.0), -normal.dot(change.cwiseQuotient(scaling.range))};
}

std::vector<VectorXd> PolishedFront(const Archive& archive, const PerformanceBuffer& buffer,
                                    std::size_t count) {
  std::vector<std::size_t> front;
  for (const auto& [cell, candidates] : buffer.cells()) {
    const std::size_t best = candidates.front().entry;
    if (!archive.ClearlyDominated(archive[best].metrics, buffer.scaling(), kLeastGain))
      front.push_back(best);
  }
  // Of many, some from everywhere: models take time.
  const std::size_t every = std::max<std::size_t>(1, front.size() / (kLookedAt * count + 1));
  const auto neighbours = static_cast<std::size_t>(2 * buffer.scaling().ideal.size());
  std::vector<PolishedDesign> polished;
  for (std::size_t i = 0; i < front.size(); i += every) {
    const VectorXd& u = archive[front[i]].u;
    const double reach = kFrontReach * DistanceToNeighbour(archive, u, front, neighbours);
    PolishedDesign design = Polished(archive, buffer.scaling(), u, reach);
    if (design.gain > kLeastGain) polished.push_back(std::move(design));
  }
  std::ranges::stable_sort(polished, std::greater<>{}, &PolishedDesign::gain);
  std::vector<VectorXd> designs;
  for (std::size_t i = 0; i < std::min(count, polished.size()); ++i)
    designs.push_back(std::move(polished[i].u));
  return designs;
}

}  // namespace mortise::pareto
