#include "services/pareto/sources/front_polishing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>
#include <utility>

#include "services/pareto/archive/front_places.h"
#include "services/pareto/models/bounded_quadratic.h"
#include "services/pareto/models/constrained_quadratic.h"
#include "services/pareto/models/first_order_expansion.h"
#include "services/pareto/models/quadratic_model.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kBeyond = 1e-2;      // delta_N: how far beyond the front the target is
constexpr double kMinReach = 1e-3;    // where there are no neighbours
constexpr std::size_t kLookedAt = 4;  // designs, for each that is wanted
constexpr int kIterations = 8;
constexpr int kShortenings = 4;
constexpr double kMinProgress = 1e-9;  // of an iteration, scaled performance
constexpr double kAside = 0.2;         // of all metrics, beside the normal
constexpr int kForgotten = 3;          // rounds after which a design is looked at again
// How far a design of the front is moved, over the distance to its neighbours, at each try.
constexpr std::array<double, 3> kFrontReach = {3, 10, 1};

// The constraints as functions of a step from `u`; none where there are none.
std::vector<QuadraticFunction> ConstraintsNear(const Archive& archive, std::size_t near,
                                               const VectorXd& u, double radius) {
  if (archive[near].constraints.size() == 0) return {};
  return ConstraintsAround(
      FitConstraintModel(archive, near, radius, archive.PriorConstraintJacobian(u)), u,
      archive.ConstraintSizes());
}

// How far to slide along `directions` of the front (D x k), after performance changed by `moved`,
// so that the change goes along the unit vector `line`; metrics that `free` has a 1 for may get
// better than that. `jacobian` (d x D) is scaled.
VectorXd BackToLine(const VectorXd& moved, const VectorXd& line, const VectorXd& free,
                    const MatrixXd& jacobian, const MatrixXd& directions) {
  if (directions.cols() == 0) return VectorXd::Zero(jacobian.cols());
  const VectorXd held = line.cwiseProduct(VectorXd::Ones(line.size()) - free);
  const VectorXd excess = moved - line * (held.dot(moved) / held.squaredNorm());
  const VectorXd off = (free.array() > 0).select(excess.cwiseMax(0.0), excess);
  const MatrixXd slopes = jacobian * directions;
  const MatrixXd across = slopes - line * (line.transpose() * slopes);
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
  if (squares.empty()) return kMinReach;
  rank = std::min(rank, squares.size()) - 1;
  std::ranges::nth_element(squares, squares.begin() + static_cast<std::ptrdiff_t>(rank));
  return std::sqrt(squares[rank]);
}

// Of many, some from everywhere: at most `most`.
std::vector<std::size_t> Some(const std::vector<std::size_t>& entries, std::size_t most) {
  std::vector<std::size_t> some;
  const std::size_t every =
      std::max<std::size_t>(1, (entries.size() + most - 1) / std::max<std::size_t>(1, most));
  for (std::size_t i = 0; most > 0 && i < entries.size(); i += every) some.push_back(entries[i]);
  return some;
}

// What is known around `u`, in scaled performance.
class Surroundings {
 public:
  Surroundings(const Archive& archive, const Scaling& scaling, const VectorXd& u, double reach)
      : scaling_(scaling), u_(u) {
    const std::size_t near = archive.Nearest(u, 1).front();
    const double radius = 2 * reach;
    model_ = FitQuadraticModel(archive, near, radius, archive.PriorJacobian(u));
    jacobian_ = model_.jacobian;
    for (Eigen::Index i = 0; i < jacobian_.rows(); ++i) {
      jacobian_.row(i) +=
          (model_.hessians[static_cast<std::size_t>(i)] * (u - model_.centre)).transpose();
    }
    jacobian_ = (scaling.range.cwiseInverse().asDiagonal() * jacobian_).eval();
    kkt_ = RecoverDuals(jacobian_, u);
    constraints_ = ConstraintsNear(archive, near, u, radius);
    lower_ = (-u).cwiseMax(-reach);
    upper_ = (1 - u.array()).matrix().cwiseMin(reach);
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (u[i] <= 0 || u[i] >= 1) lower_[i] = upper_[i] = 0;
    }
  }

  const KktPoint& kkt() const { return kkt_; }
  VectorXd Normal() const { return kkt_.alpha.normalized(); }

  VectorXd Performance() const { return scaling_.Apply(model_.Predict(u_)); }

  // Of performance.
  VectorXd ChangeBy(const VectorXd& step) const {
    return scaling_.Apply(model_.Predict(u_ + step)) - Performance();
  }

  // How much nearer a step comes to where StepBeyond goes.
  double GainOf(const VectorXd& step, const VectorXd& counted) const {
    return kBeyond - counted.cwiseProduct(ChangeBy(step) + kBeyond * Normal()).norm();
  }

  // Towards kBeyond behind the front, where those metrics count that `counted` (d) has a 1 for:
  // Newton's method on the models.
  VectorXd StepBeyond(const VectorXd& counted) const {
    VectorXd step = VectorXd::Zero(u_.size());
    double gain = 0;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      const QuadraticFunction distance = DistanceAround(step, counted);
      VectorXd more = MinimizeBoundedQuadratic(distance.gradient, distance.hessian, lower_ - step,
                                               upper_ - step);
      if (!MayTake(step + more)) return WithinConstraints(counted);
      double further = GainOf(step + more, counted);
      // The squared distance is a quadratic near by only.
      for (int shortening = 0; shortening < kShortenings && !(further >= gain); ++shortening) {
        more *= 0.25;
        further = GainOf(step + more, counted);
      }
      if (!(further >= gain)) break;
      step += more;
      if (further < gain + kMinProgress) break;
      gain = further;
    }
    return step;
  }

  // Along the front, from `step` back to the line through `u` along `line`, see BackToLine; `step`
  // where constraints are in the way.
  VectorXd SlideBack(const VectorXd& step, const VectorXd& line, const VectorXd& free) const {
    const MatrixXd hessian = model_.WeightedHessian(kkt_.alpha.cwiseQuotient(scaling_.range));
    const VectorXd slide = BackToLine(ChangeBy(step), line, free, jacobian_,
                                      ExpansionDirections(kkt_, jacobian_, hessian));
    const VectorXd slid = (step + slide).cwiseMax(lower_).cwiseMin(upper_);
    return MayTake(step) && MayTake(slid) ? slid : step;
  }

 private:
  // Half the squared distance to where StepBeyond goes, around `step`.
  QuadraticFunction DistanceAround(const VectorXd& step, const VectorXd& counted) const {
    MatrixXd jacobian = model_.jacobian;
    for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
      jacobian.row(i) +=
          (model_.hessians[static_cast<std::size_t>(i)] * (u_ + step - model_.centre)).transpose();
    }
    jacobian = (scaling_.range.cwiseInverse().asDiagonal() * jacobian).eval();
    const VectorXd residual = counted.cwiseProduct(ChangeBy(step) + kBeyond * Normal());
    return {0, jacobian.transpose() * residual,
            jacobian.transpose() * counted.asDiagonal() * jacobian +
                model_.WeightedHessian(residual.cwiseQuotient(scaling_.range))};
  }

  VectorXd WithinConstraints(const VectorXd& counted) const {
    return MinimizeWithin(DistanceAround(VectorXd::Zero(u_.size()), counted), constraints_, lower_,
                          upper_);
  }

  bool MayTake(const VectorXd& step) const { return !(Violation(constraints_, step) > 0); }

  const Scaling& scaling_;
  VectorXd u_;
  QuadraticModel model_;
  MatrixXd jacobian_;  // d x D at u
  KktPoint kkt_;
  std::vector<QuadraticFunction> constraints_;
  VectorXd lower_, upper_;  // of steps
};

// Picks from each cell the trade-off that is nearest to the ideal. With further ones, where the
// front runs along the rays, rounds of polishing would not come to an end.
std::vector<std::size_t> NearestOfCells(const std::vector<FrontPlace>& places) {
  std::vector<std::size_t> nearest;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0 || places[i].cell != places[i - 1].cell) {
      nearest.push_back(places[i].candidates.front().entry);
    }
  }
  return nearest;
}

}  // namespace

PolishedDesign Polished(const Archive& archive, const Scaling& scaling, const VectorXd& u,
                        double reach) {
  const Surroundings here(archive, scaling, u, reach);
  if (here.kkt().free.empty()) return {u, 0};
  const VectorXd normal = here.Normal();
  const VectorXd all = VectorXd::Ones(normal.size());
  VectorXd step = here.StepBeyond(all);
  double gain = here.GainOf(step, all);
  VectorXd free = VectorXd::Zero(normal.size());
  if (normal.minCoeff() <= 0) {
    // Metrics without weight that get better may do so as far as they like.
    free = (normal.array() <= 0 && here.ChangeBy(step).array() < 0).cast<double>();
    const VectorXd further = here.StepBeyond(all - free);
    const double further_gain = here.GainOf(further, all - free);
    if (further_gain > gain && free.dot(here.ChangeBy(further).cwiseMax(0.0)) == 0) {
      step = further;
      gain = further_gain;
    }
  }
  // A little to the better side in all metrics, so that the new design is better than u in all.
  const VectorXd line = normal + kAside * all;
  step = here.SlideBack(step, line.normalized(), free);
  if (!step.allFinite() || !std::isfinite(gain)) return {u, 0};
  return {(u + step).cwiseMax(0.0).cwiseMin(1.0), gain};
}

std::vector<VectorXd> FrontPolishing::Next(const Archive& archive, const PerformanceBuffer& buffer,
                                           std::size_t count, const Choice& choice) {
  ++rounds_;
  const std::vector<std::size_t> best = NearestOfCells(PlacesOfFront(archive, buffer));
  const auto neighbours = static_cast<std::size_t>(2 * buffer.scaling().ideal.size());
  std::vector<std::pair<PolishedDesign, std::size_t>> polished;
  for (const std::size_t entry : LookedAt(archive, best, kLookedAt * count, choice.least)) {
    const VectorXd& u = archive[entry].u;
    Tries& tries = tries_[entry];
    const double reach =
        kFrontReach[tries.count] * DistanceToNeighbour(archive, u, best, neighbours);
    PolishedDesign design = Polished(archive, buffer.scaling(), u, reach);
    tries.gain = design.gain;
    tries.round = rounds_;
    if (design.gain > choice.least && design.gain <= choice.most) {
      polished.emplace_back(std::move(design), entry);
    }
  }
  const std::set<std::size_t> is_best(best.begin(), best.end());
  std::ranges::stable_sort(polished, std::greater<>{}, [&](const auto& each) {
    return std::pair(is_best.contains(each.second), each.first.gain);
  });
  const std::size_t taken = std::min(count, polished.size());
  std::vector<VectorXd> designs;
  for (std::size_t i = 0; i < taken; ++i) {
    auto& [design, entry] = polished[choice.typical ? i * polished.size() / taken : i];
    ++tries_[entry].count;
    designs.push_back(std::move(design.u));
  }
  return designs;
}

// At most `most`: of `best`, then of the other trade-offs, those that were not looked at yet, then
// those that were.
std::vector<std::size_t> FrontPolishing::LookedAt(const Archive& archive,
                                                  const std::vector<std::size_t>& best,
                                                  std::size_t most, double least_gain) const {
  const std::set<std::size_t> is_best(best.begin(), best.end());
  std::array<std::vector<std::size_t>, 4> groups;
  const auto group = [&](std::size_t entry, std::size_t first) {
    const auto tries = tries_.find(entry);
    if (tries == tries_.end()) {
      groups[first].push_back(entry);
    } else if (tries->second.count < kFrontReach.size() &&
               (tries->second.gain > least_gain || rounds_ - tries->second.round >= kForgotten)) {
      groups[first + 1].push_back(entry);
    }
  };
  for (const std::size_t entry : best) group(entry, 0);
  for (const std::size_t entry : archive.non_dominated()) {
    if (!is_best.contains(entry)) group(entry, 2);
  }
  std::vector<std::size_t> entries;
  for (const std::vector<std::size_t>& each : groups) {
    std::ranges::copy(Some(each, most - std::min(most, entries.size())),
                      std::back_inserter(entries));
  }
  return entries;
}

}  // namespace mortise::pareto
