// The state machine of a local optimisation.
#include "services/pareto/sources/local_optimization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "services/pareto/models/bounded_quadratic.h"

namespace mortise::pareto {
namespace {

constexpr int kFailureLimit = 5;
constexpr int kTightenLimit = 8;

}  // namespace

LocalOptimization::LocalOptimization(const Options& options, const Scaling& scaling,
                                     const Target& target, const Eigen::VectorXd& start)
    : options_(options),
      scaling_(scaling),
      target_(target),
      start_(start),
      radius_(options.initial_radius) {
  queue_.push_back(start);
  waiting_ = Waiting::kStart;
}

LocalOptimization::LocalOptimization(const Options& options, const Scaling& scaling,
                                     const Target& target, std::size_t start)
    : options_(options),
      scaling_(scaling),
      target_(target),
      best_(start),
      radius_(options.initial_radius) {}

Eigen::VectorXd LocalOptimization::Residual(const Archive& archive, std::size_t entry) const {
  return scaling_.Apply(archive[entry].metrics) - target_.z;
}

std::optional<Eigen::VectorXd> LocalOptimization::Ask(Archive& archive) {
  if (stop_ != StopReason::kNone) return std::nullopt;
  if (queue_.empty() && outstanding_ > 0) return std::nullopt;
  if (evaluations_ >= options_.evaluations) {
    stop_ = StopReason::kBudget;
    return std::nullopt;
  }
  if (queue_.empty()) {
    if (options_.differences && !OffersEvery(archive[*best_].jacobian)) {
      options_.differences = false;
      QueueDifferences(archive);
    } else {
      const std::optional<Eigen::VectorXd> point = NextPoint(archive);
      if (!point) return std::nullopt;
      queue_.push_back(*point);
    }
  }
  const Eigen::VectorXd point = queue_.front();
  queue_.pop_front();
  ++outstanding_;
  ++evaluations_;
  return point;
}

void LocalOptimization::QueueDifferences(const Archive& archive) {
  const Eigen::VectorXd& u = archive[*best_].u;
  const Eigen::VectorXd steps = 0.5 * options_.initial_radius * archive.lengths();
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    Eigen::VectorXd point = u;
    point[i] += u[i] < 0.5 ? steps[i] : -steps[i];
    queue_.push_back(point);
  }
  waiting_ = Waiting::kDifferences;
}

LocalOptimization::Merit LocalOptimization::MeritOf(const Archive& archive,
                                                    std::size_t entry) const {
  return {archive.Violation(entry), Residual(archive, entry).norm()};
}

// `entry` may have failed.
bool LocalOptimization::IsBetter(const Archive& archive, std::size_t entry,
                                 std::size_t than) const {
  if (!archive[entry].evaluated) return false;
  const Merit one = MeritOf(archive, entry), other = MeritOf(archive, than);
  return one.violation != other.violation ? one.violation < other.violation
                                          : one.distance < other.distance;
}

// The models of all constraints around the best point, each in units of its size, raised by their
// margins.
std::vector<QuadraticFunction> LocalOptimization::ConstraintsAt(Archive& archive) {
  const Eigen::VectorXd sizes = archive.ConstraintSizes();
  if (sizes.size() == 0) return {};
  if (margins_.size() == 0) margins_ = Eigen::VectorXd::Zero(sizes.size());
  const Eigen::VectorXd u = archive[*best_].u;
  const QuadraticModel model =
      FitConstraintModel(archive, *best_, radius_, archive.PriorConstraintJacobian(u));
  archive.RememberConstraints(*best_, model.jacobian);
  std::vector<QuadraticFunction> constraints = ConstraintsAround(model, u, sizes);
  for (std::size_t j = 0; j < constraints.size(); ++j) {
    double& margin = margins_[static_cast<Eigen::Index>(j)];
    // What there is to spare can be halved each time.
    if (constraints[j].value <= 0) margin = std::min(margin, -0.5 * constraints[j].value);
    constraints[j].value += margin;
  }
  return constraints;
}

void LocalOptimization::JoinTheBest(const Archive& archive) {
  double least = archive[*best_].feasible ? Residual(archive, *best_).norm() - options_.tolerance
                                          : std::numeric_limits<double>::infinity();
  for (const std::size_t other : archive.non_dominated()) {
    const double distance = Residual(archive, other).norm();
    if (distance >= least) continue;
    least = distance;
    best_ = other;
    failures_ = 0;
  }
}

std::optional<Eigen::VectorXd> LocalOptimization::NextPoint(Archive& archive) {
  if (options_.join) JoinTheBest(archive);
  if (!archive[*best_].feasible) return RestoringPoint(archive);
  const Eigen::VectorXd u = archive[*best_].u;
  const Eigen::MatrixXd prior = archive.PriorJacobian(u);
  const QuadraticModel model = FitQuadraticModel(archive, *best_, radius_, prior);
  archive.Remember(*best_, model.jacobian);
  const Eigen::VectorXd r = Residual(archive, *best_);
  const Eigen::MatrixXd J = scaling_.range.cwiseInverse().asDiagonal() * model.jacobian;
  const Eigen::VectorXd g = J.transpose() * r;
  const Eigen::MatrixXd B =
      J.transpose() * J + model.WeightedHessian(r.cwiseQuotient(scaling_.range));
  const Eigen::VectorXd lower = LeastStep(archive), upper = MostStep(archive);
  constraints_ = ConstraintsAt(archive);
  stepped_ = MinimizeBoundedQuadratic(g, B, lower, upper);
  if (Violation(constraints_, stepped_) > 0) {
    stepped_ = MinimizeWithin({0, g, B}, constraints_, lower, upper);
  }
  predicted_decrease_ = -(g.dot(stepped_) + 0.5 * stepped_.dot(B * stepped_));
  step_length_ = stepped_.cwiseQuotient(archive.lengths()).lpNorm<Eigen::Infinity>();

  const bool small = predicted_decrease_ <= options_.tolerance * r.norm() || step_length_ < 1e-9;
  // What is believed of slopes nearby is trusted until steps fail.
  const bool doubtful = failures_ >= 2 || (small && prior.size() == 0);
  if (doubtful && !model.exact_gradients) {
    const std::optional<Eigen::VectorXd> geometry = GeometryPoint(archive, g);
    if (geometry) {
      waiting_ = Waiting::kGeometry;
      return geometry;
    }
  }
  if (small) {
    stop_ = StopReason::kConverged;
    return std::nullopt;
  }
  waiting_ = Waiting::kStep;
  return (u + stepped_).cwiseMax(0.0).cwiseMin(1.0);
}

// Where the constraints that the best point violates are met, as far as their models tell.
std::optional<Eigen::VectorXd> LocalOptimization::RestoringPoint(Archive& archive) {
  constraints_ = ConstraintsAt(archive);
  stepped_ = ReduceViolation(constraints_, LeastStep(archive), MostStep(archive));
  predicted_decrease_ = Violation(constraints_, Eigen::VectorXd::Zero(stepped_.size())) -
                        Violation(constraints_, stepped_);
  step_length_ = stepped_.cwiseQuotient(archive.lengths()).lpNorm<Eigen::Infinity>();
  const bool exact = OffersEvery(archive[*best_].constraint_jacobian);
  if (failures_ >= 2 && !exact) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(stepped_.size());
    for (const QuadraticFunction& constraint : constraints_) {
      slope += std::max(0.0, constraint.value) * constraint.gradient;
    }
    if (const std::optional<Eigen::VectorXd> geometry = GeometryPoint(archive, slope)) {
      waiting_ = Waiting::kGeometry;
      return geometry;
    }
  }
  if (!(predicted_decrease_ > 0) || step_length_ < 1e-9) {
    stop_ = StopReason::kStalled;
    return std::nullopt;
  }
  waiting_ = Waiting::kStep;
  return (archive[*best_].u + stepped_).cwiseMax(0.0).cwiseMin(1.0);
}

Eigen::VectorXd LocalOptimization::LeastStep(const Archive& archive) const {
  return (-archive[*best_].u).cwiseMax(-radius_ * archive.lengths());
}

Eigen::VectorXd LocalOptimization::MostStep(const Archive& archive) const {
  return (1 - archive[*best_].u.array()).matrix().cwiseMin(radius_ * archive.lengths());
}

std::optional<Eigen::VectorXd> LocalOptimization::GeometryPoint(const Archive& archive,
                                                                const Eigen::VectorXd& gradient) {
  const Eigen::VectorXd& centre = archive[*best_].u;
  const Eigen::Index D = centre.size();
  if (geometry_points_ >= D / 2 + 2) return std::nullopt;
  const double reach = std::max(radius_, 0.02);
  const Eigen::VectorXd reaches = reach * archive.lengths();
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(D, D);
  for (const std::size_t other :
       SpreadNeighbours(archive, *best_, static_cast<std::size_t>(2 * D + 4))) {
    const Eigen::VectorXd s = (archive[other].u - centre).cwiseQuotient(reaches);
    if (s.norm() > 6) break;
    spread += s * s.transpose() / std::max(1.0, s.squaredNorm());
  }
  // A parameter at a bound that every descent would push further out needs no more looks.
  for (Eigen::Index i = 0; i < D; ++i) {
    if ((centre[i] <= 0 && gradient[i] > 0) || (centre[i] >= 1 && gradient[i] < 0)) {
      spread(i, i) += 1;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(spread);
  if (eigen.eigenvalues()[0] > 0.02) return std::nullopt;
  const Eigen::VectorXd v = eigen.eigenvectors().col(0);
  const Eigen::VectorXd offset =
      reaches.cwiseProduct(v.dot(reaches.cwiseProduct(gradient)) > 0 ? -v : v);
  const auto length_to = [&](const Eigen::VectorXd& point) {
    return (point - centre).cwiseQuotient(reaches).norm();
  };
  Eigen::VectorXd point = (centre + offset).cwiseMax(0.0).cwiseMin(1.0);
  if (length_to(point) < 0.3) point = (centre - offset).cwiseMax(0.0).cwiseMin(1.0);
  ++geometry_points_;
  if (length_to(point) < 0.1) return std::nullopt;
  return point;
}

void LocalOptimization::Tell(Archive& archive, std::size_t entry) {
  --outstanding_;
  switch (waiting_) {
    case Waiting::kNothing:
      break;
    case Waiting::kStart:
      if (archive[entry].evaluated) {
        best_ = entry;
      } else {
        stop_ = StopReason::kStartFailed;
      }
      break;
    case Waiting::kDifferences:
    case Waiting::kGeometry:
      if (IsBetter(archive, entry, *best_)) best_ = entry;
      break;
    case Waiting::kStep:
      Judge(archive, entry);
      break;
  }
  if (stop_ == StopReason::kNone) TightenTarget(archive);
}

// Of the actual to the predicted decrease by the last step; below 0 where that failed.
double LocalOptimization::RatioOf(const Archive& archive, std::size_t entry) const {
  const ArchiveEntry& told = archive[entry];
  if (!told.evaluated) return -1;
  if (!archive[*best_].feasible) {
    return (archive.Violation(*best_) - archive.Violation(entry)) / predicted_decrease_;
  }
  if (!told.feasible) return -1;
  const double before = 0.5 * Residual(archive, *best_).squaredNorm();
  const double after = 0.5 * Residual(archive, entry).squaredNorm();
  return (before - after) / predicted_decrease_;
}

// A constraint that was violated by more than its model said is kept away from by as much again;
// half of that from each time that it is met.
void LocalOptimization::LearnMargins(const Archive& archive, std::size_t entry) {
  if (constraints_.empty() || !archive[entry].evaluated) return;
  const Eigen::VectorXd actual =
      archive[entry].constraints.cwiseQuotient(archive.ConstraintSizes());
  for (Eigen::Index j = 0; j < margins_.size(); ++j) {
    const double predicted = constraints_[static_cast<std::size_t>(j)](stepped_) - margins_[j];
    margins_[j] = actual[j] > 0 ? std::max(2 * (actual[j] - predicted), 0.0) : 0.5 * margins_[j];
  }
}

void LocalOptimization::Judge(const Archive& archive, std::size_t entry) {
  LearnMargins(archive, entry);
  const double ratio = RatioOf(archive, entry);
  if (IsBetter(archive, entry, *best_)) best_ = entry;
  if (ratio > 0.7) {
    radius_ = std::clamp(2 * step_length_, radius_, 1.0);
  } else if (ratio < 0.25) {
    radius_ = 0.5 * std::min(radius_, step_length_);
  }
  failures_ = ratio > 0.05 ? 0 : failures_ + 1;
  if (failures_ >= kFailureLimit || radius_ < options_.minimal_radius) stop_ = StopReason::kStalled;
}

void LocalOptimization::TightenTarget(const Archive& archive) {
  if (tightened_ >= kTightenLimit || !archive[*best_].feasible) return;
  const Eigen::VectorXd r = Residual(archive, *best_);
  if (r.norm() > 0.2 * target_.reach && r.maxCoeff() > 0.2 * target_.reach) return;
  // Each time twice as far: where the front really is may be many ranges of the first samples away.
  target_.reach *= 2;
  target_.z = scaling_.Apply(archive[*best_].metrics) + target_.reach * target_.direction;
  ++tightened_;
}

}  // namespace mortise::pareto
