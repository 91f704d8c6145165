// The state machine of a local optimisation.
#include "services/pareto/local_optimization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "services/pareto/bounded_quadratic.h"

namespace mortise::pareto {
namespace {

constexpr int kFailureLimit = 5;
constexpr int kTightenLimit = 8;

bool OffersEveryGradient(const ArchiveEntry& entry) {
  if (entry.jacobian.size() == 0) return false;
  return !entry.jacobian.array().isNaN().rowwise().all().any();
}

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
    if (options_.differences && !OffersEveryGradient(archive[*best_])) {
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
  const double step = 0.5 * options_.initial_radius;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    Eigen::VectorXd point = u;
    point[i] += u[i] < 0.5 ? step : -step;
    queue_.push_back(point);
  }
  waiting_ = Waiting::kDifferences;
}

void LocalOptimization::JoinTheBest(const Archive& archive) {
  double least = Residual(archive, *best_).norm() - options_.tolerance;
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
  const Eigen::VectorXd u = archive[*best_].u;
  const Eigen::MatrixXd prior = archive.PriorJacobian(u);
  const QuadraticModel model = FitQuadraticModel(archive, *best_, radius_, prior);
  archive.Remember(*best_, model.jacobian);
  const Eigen::VectorXd r = Residual(archive, *best_);
  const Eigen::MatrixXd J = scaling_.range.cwiseInverse().asDiagonal() * model.jacobian;
  const Eigen::VectorXd g = J.transpose() * r;
  const Eigen::MatrixXd B =
      J.transpose() * J + model.WeightedHessian(r.cwiseQuotient(scaling_.range));
  const Eigen::VectorXd lower = (-u).cwiseMax(-radius_);
  const Eigen::VectorXd upper = (Eigen::VectorXd::Ones(u.size()) - u).cwiseMin(radius_);
  const Eigen::VectorXd p = MinimizeBoundedQuadratic(g, B, lower, upper);
  predicted_decrease_ = -(g.dot(p) + 0.5 * p.dot(B * p));
  step_length_ = p.lpNorm<Eigen::Infinity>();

  const bool small = predicted_decrease_ <= options_.tolerance * r.norm() || step_length_ < 1e-9;
  // What is believed of slopes nearby is trusted until steps fail.
  const bool doubtful = failures_ >= 2 || (small && prior.size() == 0);
  if (doubtful && !model.exact_gradients) {
    const std::optional<Eigen::VectorXd> geometry = GeometryPoint(archive, model, g);
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
  return (u + p).cwiseMax(0.0).cwiseMin(1.0);
}

std::optional<Eigen::VectorXd> LocalOptimization::GeometryPoint(const Archive& archive,
                                                                const QuadraticModel& model,
                                                                const Eigen::VectorXd& gradient) {
  const Eigen::Index D = model.centre.size();
  if (geometry_points_ >= D / 2 + 2) return std::nullopt;
  const double reach = std::max(radius_, 0.02);
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(D, D);
  for (const std::size_t other :
       SpreadNeighbours(archive, *best_, static_cast<std::size_t>(2 * D + 4))) {
    const Eigen::VectorXd s = (archive[other].u - model.centre) / reach;
    if (s.norm() > 6) break;
    spread += s * s.transpose() / std::max(1.0, s.squaredNorm());
  }
  // A parameter at a bound that every descent would push further out needs no more looks.
  for (Eigen::Index i = 0; i < D; ++i)
    if ((model.centre[i] <= 0 && gradient[i] > 0) || (model.centre[i] >= 1 && gradient[i] < 0))
      spread(i, i) += 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(spread);
  if (eigen.eigenvalues()[0] > 0.02) return std::nullopt;
  Eigen::VectorXd v = eigen.eigenvectors().col(0);
  if (v.dot(gradient) > 0) v = -v;
  Eigen::VectorXd point = (model.centre + reach * v).cwiseMax(0.0).cwiseMin(1.0);
  if ((point - model.centre).norm() < 0.3 * reach)
    point = (model.centre - reach * v).cwiseMax(0.0).cwiseMin(1.0);
  ++geometry_points_;
  if ((point - model.centre).norm() < 0.1 * reach) return std::nullopt;
  return point;
}

void LocalOptimization::Tell(Archive& archive, std::size_t entry) {
  --outstanding_;
  switch (waiting_) {
    case Waiting::kNothing:
      break;
    case Waiting::kStart:
      if (archive[entry].feasible) {
        best_ = entry;
      } else {
        stop_ = StopReason::kStartFailed;
      }
      break;
    case Waiting::kDifferences:
    case Waiting::kGeometry:
      if (archive[entry].feasible &&
          Residual(archive, entry).norm() < Residual(archive, *best_).norm())
        best_ = entry;
      break;
    case Waiting::kStep:
      Judge(archive, entry);
      break;
  }
  if (stop_ == StopReason::kNone) TightenTarget(archive);
}

void LocalOptimization::Judge(const Archive& archive, std::size_t entry) {
  double ratio = -1;
  if (archive[entry].feasible) {
    const double before = 0.5 * Residual(archive, *best_).squaredNorm();
    const double after = 0.5 * Residual(archive, entry).squaredNorm();
    ratio = (before - after) / predicted_decrease_;
    if (after < before) best_ = entry;
  }
  if (ratio > 0.7) {
    radius_ = std::clamp(2 * step_length_, radius_, 1.0);
  } else if (ratio < 0.25) {
    radius_ = 0.5 * std::min(radius_, step_length_);
  }
  failures_ = ratio > 0.05 ? 0 : failures_ + 1;
  if (failures_ >= kFailureLimit || radius_ < options_.minimal_radius) stop_ = StopReason::kStalled;
}

void LocalOptimization::TightenTarget(const Archive& archive) {
  if (tightened_ >= kTightenLimit) return;
  const Eigen::VectorXd r = Residual(archive, *best_);
  if (r.norm() > 0.2 * target_.reach && r.maxCoeff() > 0.2 * target_.reach) return;
  // Each time twice as far: where the front really is may be many ranges of the first samples away.
  target_.reach *= 2;
  target_.z = scaling_.Apply(archive[*best_].metrics) + target_.reach * target_.direction;
  ++tightened_;
}

}  // namespace mortise::pareto
