// The walk over an affine piece of the front.
#include "services/pareto/sources/patch_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/pareto/models/bounded_quadratic.h"

namespace mortise::pareto {
namespace {

constexpr int kBisectionDepth = 6;
constexpr double kNoWeight = 1e-3;  // of a metric, out of 1 for all
constexpr double kModelRadius = 0.1;
constexpr double kActiveDistance = 0.02;      // from a constraint, unit coordinates
constexpr double kMaxMargin = 0.05;           // from a constraint, in units of its size
constexpr double kMaxCorrection = 0.25;       // of each unit coordinate
constexpr Eigen::Index kLargeDimensions = 3;  // of a piece that has most of its nodes far out
constexpr std::size_t kLookedAt = 16;         // nodes, before one is chosen there
constexpr double kFar = 1e4;                  // steps, more than any piece has
constexpr int kMaxRedundant = 20;             // nodes, and a quarter of the evaluations
constexpr int kRedundantShare = 4;
constexpr std::size_t kNodeLimit = 5000;  // a patch whose nodes are all covered ends somewhere

// The largest s in [0, 1] for which centre + s offset stays within the unit box.
double Reach(const Eigen::VectorXd& centre, const Eigen::VectorXd& offset) {
  double reach = 1;
  for (Eigen::Index i = 0; i < centre.size(); ++i) {
    if (offset[i] > 1e-15) reach = std::min(reach, (1 - centre[i]) / offset[i]);
    if (offset[i] < -1e-15) reach = std::min(reach, centre[i] / -offset[i]);
  }
  return std::max(reach, 0.0);
}

// Whether a metric that weighs nothing could still be improved, at first order, where the others
// do not change: as on a whole face on which one metric is at its best.
bool IsOnlyWeaklyOptimal(const KktPoint& kkt, const Eigen::MatrixXd& jacobian) {
  for (Eigen::Index i = 0; i < kkt.alpha.size(); ++i) {
    const double slope = (jacobian(i, kkt.free) * kkt.tangent).norm();
    if (kkt.alpha[i] < kNoWeight && slope > 0.1 * jacobian.row(i).norm() && slope > 0) return true;
  }
  return false;
}

// Drops directions along which a metric gains at first order, none loses, and the curvature of the
// weighted metrics does not object: they show that the design was only weakly optimal.
Eigen::MatrixXd WithoutFreeGains(const Eigen::MatrixXd& directions, const Eigen::MatrixXd& J,
                                 const Eigen::MatrixXd& H) {
  Eigen::MatrixXd kept(directions.rows(), 0);
  for (Eigen::Index k = 0; k < directions.cols(); ++k) {
    const Eigen::VectorXd v = directions.col(k);
    const Eigen::VectorXd change = J * v;
    const double size = change.norm();
    const bool trade = change.minCoeff() < -1e-3 * size && change.maxCoeff() > 1e-3 * size;
    if (!trade && !(v.dot(H * v) > 1e-2 * size)) continue;
    kept.conservativeResize(Eigen::NoChange, kept.cols() + 1);
    kept.col(kept.cols() - 1) = v;
  }
  return kept;
}

// From predicted metrics to the nearest known trade-off, in scaled performance.
double SquaredHole(const Archive& archive, const Scaling& scaling,
                   const Eigen::VectorXd& predicted) {
  const auto front = archive.non_dominated_metrics();
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < front.cols(); ++k) {
    double squared = 0;
    for (Eigen::Index i = 0; i < predicted.size(); ++i) {
      squared += std::pow((predicted[i] - front(i, k)) / scaling.range[i], 2);
    }
    least = std::min(least, squared);
  }
  return least;
}

}  // namespace

PatchSampling::PatchSampling(const Options& options, const Scaling& scaling, std::size_t entry)
    : options_(options), scaling_(scaling) {
  piece_.entry = entry;
}

void PatchSampling::Start(Archive& archive) {
  started_ = true;
  const Eigen::VectorXd u = archive[piece_.entry].u;
  piece_.centre = u;
  piece_.directions = Eigen::MatrixXd(u.size(), 0);
  model_ = FitQuadraticModel(archive, piece_.entry, kModelRadius, archive.PriorJacobian(u));
  const Eigen::MatrixXd J = scaling_.range.cwiseInverse().asDiagonal() * model_->jacobian;
  RecoverDualsAt(archive, piece_.entry);
  if (!IsCritical(J)) {
    finished_ = true;
    return;
  }
  const Eigen::Index d = model_->value.size();
  if (model_->exact_gradients && static_cast<Eigen::Index>(kkt_.free.size()) > d - 1) {
    hessian_coordinates_.assign(kkt_.free.begin(), kkt_.free.end());
    hessian_pending_ = static_cast<int>(kkt_.free.size());
  } else if (options_.measures && !model_->exact_gradients) {
    measurement_.emplace(*model_, kkt_.free, options_.measured_step);
  } else {
    Open(archive);
  }
}

// At an entry that the model is of.
void PatchSampling::RecoverDualsAt(const Archive& archive, std::size_t entry) {
  const Eigen::VectorXd& u = archive[entry].u;
  const Eigen::MatrixXd J = scaling_.range.cwiseInverse().asDiagonal() * model_->jacobian;
  constraint_hessian_ = Eigen::MatrixXd::Zero(u.size(), u.size());
  std::vector<QuadraticFunction> active;
  if (archive[entry].constraints.size() > 0) {
    active = ConstraintsAround(
        FitConstraintModel(archive, entry, kModelRadius, archive.PriorConstraintJacobian(u)), u,
        archive.ConstraintSizes());
    std::erase_if(active, [](const QuadraticFunction& constraint) {
      return constraint.value < -kActiveDistance * constraint.gradient.norm();
    });
  }
  Eigen::MatrixXd normals(static_cast<Eigen::Index>(active.size()), u.size());
  for (std::size_t k = 0; k < active.size(); ++k) {
    normals.row(static_cast<Eigen::Index>(k)) = active[k].gradient.transpose();
  }
  kkt_ = RecoverDuals(J, u, normals);
  for (std::size_t k = 0; k < active.size(); ++k) {
    constraint_hessian_ += kkt_.mu[static_cast<Eigen::Index>(k)] * active[k].hessian;
  }
}

// `point`, or one nearby that meets the constraints as far as is known at `parent`.
Eigen::VectorXd PatchSampling::WithinConstraints(const Archive& archive,
                                                 const Eigen::VectorXd& point,
                                                 std::size_t parent) const {
  if (archive[parent].constraints.size() == 0) return point;
  std::vector<QuadraticFunction> constraints =
      ConstraintsAround(FitConstraintModel(archive, parent, kModelRadius,
                                           archive.PriorConstraintJacobian(archive[parent].u)),
                        point, archive.ConstraintSizes());
  for (QuadraticFunction& constraint : constraints) constraint.value += margin_;
  if (!(Violation(constraints, Eigen::VectorXd::Zero(point.size())) > 0)) return point;
  const Eigen::VectorXd lower = (-point).cwiseMax(-kMaxCorrection);
  const Eigen::VectorXd upper = (1 - point.array()).matrix().cwiseMin(kMaxCorrection);
  return (point + ReduceViolation(constraints, lower, upper)).cwiseMax(0.0).cwiseMin(1.0);
}

void PatchSampling::LearnMargin(const Archive& archive, std::size_t entry) {
  const Eigen::VectorXd above = archive[entry].constraints.cwiseQuotient(archive.ConstraintSizes());
  margin_ = std::max(margin_, std::min(2 * above.maxCoeff(), kMaxMargin));
}

bool PatchSampling::IsCritical(const Eigen::MatrixXd& jacobian) const {
  const double limit =
      model_->exact_gradients ? options_.exact_critical_residual : options_.critical_residual;
  return !kkt_.free.empty() && kkt_.residual <= limit && !IsOnlyWeaklyOptimal(kkt_, jacobian);
}

// Where the metrics, weighted by the duals, are least within the steps of the measurement.
std::optional<Eigen::VectorXd> PatchSampling::BetterCentre() const {
  const Eigen::VectorXd weights = kkt_.alpha.cwiseQuotient(scaling_.range);
  const Eigen::VectorXd& u = piece_.centre;
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(u.size()), upper = lower;
  for (const Eigen::Index i : kkt_.free) {
    lower[i] = std::max(-u[i], -2 * options_.measured_step);
    upper[i] = std::min(1 - u[i], 2 * options_.measured_step);
  }
  const Eigen::VectorXd p = MinimizeBoundedQuadratic(
      model_->jacobian.transpose() * weights, model_->WeightedHessian(weights), lower, upper);
  if (!p.allFinite() || p.lpNorm<Eigen::Infinity>() < 1e-6) return std::nullopt;
  return (u + p).cwiseMax(0.0).cwiseMin(1.0);
}

void PatchSampling::FinishMeasurement(const Archive& archive) {
  model_ = measurement_->Measured();
  const Eigen::MatrixXd J = scaling_.range.cwiseInverse().asDiagonal() * model_->jacobian;
  RecoverDualsAt(archive, piece_.entry);
  if (!IsCritical(J)) {
    finished_ = true;
    return;
  }
  // Where constraints hold it, the metrics alone do not say what is better.
  if (!(kkt_.mu.array() > 0).any()) better_centre_ = BetterCentre();
  if (!better_centre_) Open(archive);
}

// To an entry nearby, if the weighted metrics are better there.
void PatchSampling::MoveCentre(const Archive& archive, std::size_t entry) {
  const ArchiveEntry& told = archive[entry];
  const Eigen::VectorXd weights = kkt_.alpha.cwiseQuotient(scaling_.range);
  if (told.feasible && weights.dot(told.metrics - model_->value) < 0) {
    const Eigen::VectorXd p = told.u - piece_.centre;
    for (Eigen::Index i = 0; i < model_->value.size(); ++i) {
      model_->jacobian.row(i) += (model_->hessians[static_cast<std::size_t>(i)] * p).transpose();
    }
    model_->centre = piece_.centre = told.u;
    model_->value = told.metrics;
    piece_.entry = entry;
    RecoverDualsAt(archive, entry);
  }
  Open(archive);
}

void PatchSampling::FinishHessian(const Archive& archive) {
  for (Eigen::MatrixXd& hessian : model_->hessians) {
    hessian = (0.5 * (hessian + hessian.transpose())).eval();
  }
  Open(archive);
}

void PatchSampling::Open(const Archive& archive) {
  const Eigen::MatrixXd scale = scaling_.range.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd J = scale * model_->jacobian;
  const Eigen::MatrixXd H =
      model_->WeightedHessian(kkt_.alpha.cwiseQuotient(scaling_.range)) + constraint_hessian_;
  piece_.directions = WithoutFreeGains(ExpansionDirections(kkt_, J, H), J, H);
  const Eigen::Index k = piece_.directions.cols();
  if (k == 0) {
    finished_ = true;
    return;
  }
  steps_.resize(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const double speed = (J * piece_.directions.col(i)).norm();
    steps_[i] = std::clamp(options_.spacing / std::max(speed, 1e-9), 0.002, 0.25);
  }
  const Node origin(static_cast<std::size_t>(k), 0);
  seen_.insert(origin);
  Expand({origin, false, piece_.entry});
  if (k == 1) Keep(archive, 0, piece_.entry, 0);
}

// To the neighbours of a node.
void PatchSampling::Expand(const Reached& from) {
  if (seen_.size() > kNodeLimit) return;
  for (std::size_t i = 0; i < from.node.size(); ++i) {
    for (const int sign : {+1, -1}) {
      Node next = from.node;
      next[i] += sign;
      if (seen_.insert(next).second) frontier_.push_back({next, from.beyond, from.parent});
    }
  }
}

// Along each direction, both ways; and along their diagonals, if that makes no more than `most`.
std::vector<PatchSampling::Node> PatchSampling::WaysOut(std::size_t most) const {
  const auto k = static_cast<std::size_t>(steps_.size());
  const bool diagonally = std::pow(3, k) - 1 <= static_cast<double>(most);
  std::vector<Node> ways;
  Node way(k, -1);
  while (true) {
    const auto moves = std::ranges::count_if(way, [](int i) { return i != 0; });
    if (moves == 1 || (moves > 1 && diagonally)) ways.push_back(way);
    std::size_t i = 0;
    while (i < k && ++way[i] == 2) way[i++] = -1;
    if (i == k) break;
  }
  return ways;
}

// Evenly along each way out, up to the bounds.
void PatchSampling::QueueProbes() {
  const std::vector<Node> ways = WaysOut(static_cast<std::size_t>(options_.probes));
  const auto k = static_cast<std::size_t>(steps_.size());
  const auto each =
      std::max<std::size_t>(1, static_cast<std::size_t>(options_.probes) / ways.size());
  for (const Node& along : ways) {
    Eigen::VectorXd t(steps_.size());
    for (std::size_t i = 0; i < k; ++i) t[i] = along[i] * steps_[i];
    const Eigen::VectorXd step = piece_.directions * t;
    const double nodes = std::floor(kFar * Reach(piece_.centre, kFar * step)) + 1;
    for (std::size_t n = 1; n <= each; ++n) {
      const double share = (static_cast<double>(n) - 0.5) / static_cast<double>(each);
      Node probe = along;
      for (int& i : probe) i *= std::max(1, static_cast<int>(std::lround(share * nodes)));
      if (seen_.insert(probe).second) frontier_.push_back({probe, true, piece_.entry});
    }
  }
}

std::optional<Eigen::VectorXd> PatchSampling::NodePoint(const Node& node, double* parameter) const {
  Eigen::VectorXd t(steps_.size());
  double inner =
      0;  // how far the lattice neighbour nearer to the centre is, as part of this offset
  double size = 0;
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    t[i] = node[static_cast<std::size_t>(i)] * steps_[i];
    size = std::max(size, std::abs(static_cast<double>(node[static_cast<std::size_t>(i)])));
  }
  inner = (size - 1) / size;
  const Eigen::VectorXd offset = piece_.directions * t;
  const double reach = Reach(piece_.centre, offset);
  if (reach <= inner + 1e-9) return std::nullopt;  // its inner neighbour is at the bound already
  *parameter = reach * t[0];
  return (piece_.centre + reach * offset).cwiseMax(0.0).cwiseMin(1.0);
}

// By a trade-off other than `but`.
bool PatchSampling::Covered(const Archive& archive, const Eigen::VectorXd& metrics,
                            std::optional<std::size_t> but) const {
  const double near = 0.5 * options_.spacing;
  const auto front = archive.non_dominated_metrics();
  for (Eigen::Index k = 0; k < front.cols(); ++k) {
    if (archive.non_dominated()[static_cast<std::size_t>(k)] == but) continue;
    double squared = 0, least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < metrics.size() && squared < near * near; ++i) {
      const double gap = (metrics[i] - front(i, k)) / scaling_.range[i];
      squared += gap * gap;
      least = std::min(least, gap);
    }
    if (squared < near * near && least > -options_.tolerance) return true;
  }
  return false;
}

std::optional<Eigen::VectorXd> PatchSampling::Ask(Archive& archive) {
  if (!started_) Start(archive);
  if (finished_) return std::nullopt;
  if (measurement_ && !measurement_->Finished()) {
    const std::optional<Eigen::VectorXd> point = measurement_->Ask();
    if (point) asked_.push_back({Request::Kind::kMeasurement, 0, {}, 0, 0});
    return point;
  }
  if (better_centre_) {
    asked_.push_back({Request::Kind::kCentre, 0, {}, 0, 0});
    return std::exchange(better_centre_, std::nullopt);
  }
  if (steps_.size() == 0 && hessian_coordinates_.empty() && hessian_pending_ == 0) {
    return std::nullopt;
  }
  if (!hessian_coordinates_.empty()) {
    const Eigen::Index i = hessian_coordinates_.front();
    hessian_coordinates_.pop_front();
    Eigen::VectorXd point = piece_.centre;
    point[i] += point[i] < 0.5 ? options_.difference : -options_.difference;
    asked_.push_back({Request::Kind::kHessian, i, {}, 0, 0});
    return point;
  }
  if (hessian_pending_ > 0) return std::nullopt;
  if (std::optional<Eigen::VectorXd> point = AskNode(archive)) return point;
  if (!bisections_.empty() && evaluations_ < options_.evaluations) {
    const Bisection next = bisections_.front();
    bisections_.pop_front();
    ++evaluations_;
    asked_.push_back({Request::Kind::kBisection, 0, {}, next.parameter, next.depth});
    const Eigen::VectorXd point =
        (piece_.centre + next.parameter * piece_.directions.col(0)).cwiseMax(0.0).cwiseMin(1.0);
    return WithinConstraints(archive, point, line_.lower_bound(next.parameter)->second);
  }
  if (std::optional<Eigen::VectorXd> point = AskAhead(archive)) return point;
  if (!asked_.empty()) return std::nullopt;
  if (options_.probes > 0 && !std::exchange(probed_, true)) {
    QueueProbes();
    return Ask(archive);
  }
  finished_ = true;
  return std::nullopt;
}

std::optional<Eigen::VectorXd> PatchSampling::AskNode(const Archive& archive) {
  const auto hole_at = [&](const Reached& reached) {
    double parameter = 0;
    const std::optional<Eigen::VectorXd> point = NodePoint(reached.node, &parameter);
    return point ? SquaredHole(archive, scaling_, model_->Predict(*point)) : 0.0;
  };
  while (!frontier_.empty() && evaluations_ < options_.evaluations) {
    if (steps_.size() >= kLargeDimensions && !frontier_.front().again) {
      const std::size_t step = std::max<std::size_t>(1, frontier_.size() / kLookedAt);
      std::size_t widest = 0;
      double most = -1;
      for (std::size_t i = 0; i < frontier_.size(); i += step) {
        const double hole = hole_at(frontier_[i]);
        if (hole <= most) continue;
        most = hole;
        widest = i;
      }
      std::swap(frontier_.front(), frontier_[widest]);
    }
    const Reached reached = frontier_.front();
    frontier_.pop_front();
    double parameter = 0;
    if (!reached.beyond) WalkOf(reached.node).asked = std::abs(reached.node[0]);
    const std::optional<Eigen::VectorXd> point = NodePoint(reached.node, &parameter);
    if (!point) {
      WalkOf(reached.node).ended = true;
      continue;
    }
    const Eigen::VectorXd possible = WithinConstraints(archive, *point, reached.parent);
    if (!reached.beyond && Covered(archive, model_->Predict(possible), std::nullopt)) {
      WalkOf(reached.node).held = std::abs(reached.node[0]);
      Expand(reached);
      continue;
    }
    ++evaluations_;
    asked_.push_back({Request::Kind::kNode, 0, reached, parameter, 0});
    return possible;
  }
  return std::nullopt;
}

PatchSampling::Walk& PatchSampling::WalkOf(const Node& node) { return walks_[node[0] > 0 ? 1 : 0]; }

// While all that is known to hold has been asked for.
std::optional<Eigen::VectorXd> PatchSampling::AskAhead(const Archive& archive) {
  if (steps_.size() != 1 || asked_.empty() || archive[piece_.entry].constraints.size() > 0) {
    return std::nullopt;
  }
  for (const int sign : {+1, -1}) {
    const Walk& walk = walks_[sign > 0 ? 1 : 0];
    const int lead = walk.asked - walk.held;
    if (walk.ended || walk.asked == 0 || lead > std::min(options_.ahead, walk.held / 2)) continue;
    const Node next{sign * (walk.asked + 1)};
    if (!seen_.insert(next).second) continue;
    frontier_.push_back({next, false, piece_.entry});
    if (std::optional<Eigen::VectorXd> point = AskNode(archive)) return point;
  }
  return std::nullopt;
}

void PatchSampling::Tell(Archive& archive, std::size_t entry) {
  const Request request = asked_.front();
  asked_.pop_front();
  const ArchiveEntry& told = archive[entry];
  if (request.kind == Request::Kind::kMeasurement) {
    measurement_->Tell(told.evaluated ? std::optional(told.metrics) : std::nullopt);
    if (measurement_->Finished()) FinishMeasurement(archive);
    return;
  }
  if (request.kind == Request::Kind::kCentre) return MoveCentre(archive, entry);
  if (request.kind == Request::Kind::kHessian) {
    if (told.evaluated && told.jacobian.size() > 0 && told.jacobian.allFinite()) {
      const double h = told.u[request.coordinate] - piece_.centre[request.coordinate];
      for (Eigen::Index i = 0; std::abs(h) > 0 && i < told.metrics.size(); ++i) {
        model_->hessians[static_cast<std::size_t>(i)].col(request.coordinate) =
            (told.jacobian.row(i) - model_->jacobian.row(i)).transpose() / h;
      }
    }
    if (--hessian_pending_ == 0) FinishHessian(archive);
    return;
  }
  const bool stepped = request.kind == Request::Kind::kNode && !request.reached.beyond;
  if (stepped && told.evaluated && !told.feasible) {
    LearnMargin(archive, entry);
    if (!request.reached.again) {
      frontier_.push_front(request.reached);
      frontier_.front().again = true;
    }
  }
  const bool holds =
      told.feasible && !archive.ClearlyDominated(told.metrics, scaling_, options_.tolerance);
  if (stepped && steps_.size() == 1) {
    Walk& walk = WalkOf(request.reached.node);
    if (holds) walk.held = std::max(walk.held, std::abs(request.reached.node[0]));
    walk.ended = walk.ended || !holds;
  }
  if (stepped && holds && Covered(archive, told.metrics, entry)) {
    ++redundant_;
    if (redundant_ > kMaxRedundant + evaluations_ / kRedundantShare) EndWalk();
  }
  if (!holds || (stepped && walk_over_)) return;
  if (request.kind == Request::Kind::kNode) {
    Expand({request.reached.node, request.reached.beyond, entry});
  }
  if (steps_.size() == 1) Keep(archive, request.parameter, entry, request.depth);
}

// Nor is it worth looking beyond.
void PatchSampling::EndWalk() {
  walk_over_ = true;
  probed_ = true;
  frontier_.clear();
  bisections_.clear();
  for (Walk& walk : walks_) walk.ended = true;
}

void PatchSampling::Keep(const Archive& archive, double parameter, std::size_t entry, int depth) {
  const auto place = line_.emplace(parameter, entry).first;
  if (depth >= kBisectionDepth) return;
  const auto consider = [&](std::map<double, std::size_t>::iterator a,
                            std::map<double, std::size_t>::iterator b) {
    const double gap =
        (scaling_.Apply(archive[a->second].metrics) - scaling_.Apply(archive[b->second].metrics))
            .norm();
    const double middle = 0.5 * (a->first + b->first);
    // Wider than twice the lattice step: nodes passed as covered lie between.
    const bool adjacent = b->first - a->first < 1.5 * steps_[0];
    if (gap > 1.6 * options_.spacing && adjacent) bisections_.push_back({middle, depth + 1});
  };
  if (place != line_.begin()) consider(std::prev(place), place);
  if (std::next(place) != line_.end()) consider(place, std::next(place));
}

}  // namespace mortise::pareto
