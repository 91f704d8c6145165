// Gaps, refinements and stochastic samples.
#include "services/pareto/discovery/track_scheduler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/pareto/archive/stochastic_sampling.h"
#include "services/pareto/sources/coordinate_search.h"
#include "services/pareto/sources/front_alignment.h"
#include "services/pareto/sources/front_polishing.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;
using Target = LocalOptimization::Target;

constexpr double kMemory = 0.9;        // weight of the past in what a way of sampling has brought
constexpr double kCoarseCells = 4096;  // about, in which tries are counted, for d > 2
constexpr std::size_t kBridges = 8;    // of a track
constexpr std::size_t kAligned = 8;    // the same
constexpr int kSweepValues = 8;
constexpr double kTransferShare = 0.1;  // of what is invested in evolution
constexpr double kAlignShare = 0.12;    // the same
// How much less other metrics count where one is looked for by itself: enough to choose among
// designs that are equal in it.
constexpr double kUnimportance = 3;
constexpr double kFarAway = 5;  // reach of what is to be as good as it can, in ranges

Target Toward(const VectorXd& from, const VectorXd& direction, double reach) {
  return {from + reach * direction, direction, reach};
}

VectorXd Diagonal(Eigen::Index d) {
  return VectorXd::Constant(d, -1 / std::sqrt(static_cast<double>(d)));
}

}  // namespace

TrackScheduler::Track TrackScheduler::Next(const Archive& archive, const PerformanceBuffer& buffer,
                                           bool force_sample) {
  const Eigen::Index d = buffer.scaling().ideal.size();
  if (opened_ <= LastOpening(d)) return OpeningTrack(archive);
  if (force_sample) return SampleTrack(archive, buffer);
  const TrackKind kind = ChooseKind();
  switch (kind) {
    case TrackKind::kBreed:
    case TrackKind::kEvolve:
    case TrackKind::kTransfer:
      return {kind, nullptr, nullptr};
    case TrackKind::kGap:
      if (d > 1 && archive.non_dominated().size() == 1) return ElsewhereTrack(archive, buffer);
      return d == 2 ? PlanarGapTrack(archive, buffer) : GapTrack(archive, buffer);
    case TrackKind::kRefine:
      return RefineTrack(archive, buffer);
    case TrackKind::kBridge:
      return BridgeTrack(archive, buffer);
    case TrackKind::kSweep:
      return SweepTrack(archive, buffer);
    case TrackKind::kPolish:
      return Polish(archive, buffer);
    case TrackKind::kAlign:
      return AlignTrack(archive, buffer);
    default:
      return SampleTrack(archive, buffer);
  }
}

void TrackScheduler::Report(TrackKind kind, double gain, int evaluations) {
  if (static_cast<std::size_t>(kind) >= kWays || evaluations == 0) return;
  const auto i = static_cast<std::size_t>(kind);
  gain_[i] = kMemory * gain_[i] + gain;
  spent_[i] = kMemory * spent_[i] + evaluations;
  const std::array<double, kWays> shares = Shares();
  for (std::size_t k = 0; k < kWays; ++k) balance_[k] += shares[k] * evaluations;
  balance_[i] -= evaluations;
}

std::array<double, TrackScheduler::kWays> TrackScheduler::Shares() const {
  std::array<double, kWays> rate{};
  double total = 0;
  const std::size_t ways = options_.explores ? kWays : kLocalWays;
  const double least = options_.least_share / static_cast<double>(ways);
  for (std::size_t i = 0; i < ways; ++i) {
    rate[i] = (gain_[i] + 1e-6) / (spent_[i] + 1);
    total += rate[i];
  }
  const double rest = 1 - options_.least_share;
  for (std::size_t i = 0; i < ways; ++i) {
    rate[i] = least + rest * rate[i] / total;
  }
  if (!options_.explores) return rate;
  for (std::size_t i = 0; i < ways; ++i) rate[i] *= 1 - investment_;
  rate[static_cast<std::size_t>(TrackKind::kEvolve)] +=
      (1 - kTransferShare - kAlignShare) * investment_;
  rate[static_cast<std::size_t>(TrackKind::kAlign)] += kAlignShare * investment_;
  rate[static_cast<std::size_t>(TrackKind::kTransfer)] += kTransferShare * investment_;
  return rate;
}

// The way that is owed most. Choosing it costs something at once, so that tracks that start side by
// side differ.
TrackKind TrackScheduler::ChooseKind() {
  const auto end = options_.explores ? balance_.end() : balance_.begin() + kLocalWays;
  const auto most = std::max_element(balance_.begin(), end);
  const auto kind = static_cast<TrackKind>(most - balance_.begin());
  const std::array<double, kWays> shares = Shares();
  for (std::size_t k = 0; k < kWays; ++k) balance_[k] += shares[k];
  *most -= 1;
  return kind;
}

int& TrackScheduler::TriesAt(const PerformanceBuffer& buffer, const VectorXd& scaled) {
  PerformanceBuffer::Options coarse;
  const Eigen::Index d = buffer.scaling().ideal.size();
  const auto angles = static_cast<double>(std::max<Eigen::Index>(d - 1, 2));
  coarse.cells_per_angle = static_cast<int>(std::lround(std::pow(kCoarseCells, 1 / angles)));
  return tries_[PerformanceBuffer(coarse, d).CellOf(scaled)];
}

// The candidate nearest to the ideal (metric -1), or best in a metric.
std::size_t TrackScheduler::OpeningStart(const Archive& archive, const Scaling& scaling,
                                         Eigen::Index metric,
                                         const std::vector<std::size_t>& candidates) const {
  std::size_t start = candidates.front();
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t entry : candidates) {
    const VectorXd y = scaling.Apply(archive[entry].metrics);
    const double value = metric < 0 ? y.norm() : y[metric];
    if (value < best) {
      best = value;
      start = entry;
    }
  }
  return start;
}

// The middle first, then each metric by itself; each from the best entry known for it.
TrackScheduler::Track TrackScheduler::OpeningTrack(const Archive& archive) {
  const Eigen::Index d = archive.WholeRange().size();
  const Eigen::Index metric = opened_ == 0 ? -1 : (opened_ - 1) % d;
  Scaling scaling = archive.CurrentScaling();
  if (options_.explores || has_gradients_) {
    // A few trade-offs in one corner would tell a range of next to nothing.
    scaling.range = archive.WholeRange().cwiseMax(1e-3 * scaling.range);
    for (Eigen::Index other = 0; metric >= 0 && other < d; ++other) {
      if (other != metric) scaling.range[other] *= kUnimportance;
    }
  }
  const bool second = opened_ > d;
  std::vector<std::size_t> candidates;
  for (std::size_t entry = options_.given;
       second && entry < std::min(options_.second_look, archive.size()); ++entry) {
    if (archive[entry].feasible) candidates.push_back(entry);
  }
  if (candidates.empty()) candidates = archive.non_dominated();
  const std::size_t start = OpeningStart(archive, scaling, metric, candidates);
  const VectorXd y = scaling.Apply(archive[start].metrics);
  LocalOptimization::Options options = options_.optimization;
  // A small budget has no evaluations to spare for slopes that its samples already tell roughly.
  options.differences = opened_ == 0 && options_.second_look > 0;
  options.join = !second;
  if (options.differences) options.evaluations += static_cast<int>(archive[start].u.size());
  VectorXd direction = Diagonal(d);
  double reach = options_.delta_s;
  if (metric >= 0) {
    direction = VectorXd::Constant(d, -0.05);  // the other metrics weigh little, but weigh
    direction[metric] = -1;
    direction.normalize();
    reach = kFarAway;
  }
  // Of many metrics all but one can be at their best where that is nearest to the ideal: a corner
  // of the front that only a target in the middle leads out of.
  const bool is_corner_likely = metric < 0 && d > 3;
  const VectorXd from = is_corner_likely ? VectorXd(-y.norm() * direction) : y;
  ++opened_;
  return {
      TrackKind::kOpening,
      std::make_unique<LocalOptimization>(options, scaling, Toward(from, direction, reach), start),
      nullptr};
}

// A front of one design: either metrics agree, or nothing leads on from there, as at a stationary
// point of a metric that is best elsewhere. Improves a metric of any other design, where that is.
TrackScheduler::Track TrackScheduler::ElsewhereTrack(const Archive& archive,
                                                     const PerformanceBuffer& buffer) {
  Scaling scaling = archive.CurrentScaling();
  scaling.range = archive.WholeRange().cwiseMax(1e-3 * scaling.range);
  std::vector<std::size_t> candidates;
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    if (archive[entry].feasible && entry != archive.non_dominated().front()) {
      candidates.push_back(entry);
    }
  }
  if (candidates.empty()) return RefineTrack(archive, buffer);
  LocalOptimization::Options options = options_.optimization;
  options.join = false;
  const std::size_t start = candidates[random_.Index(candidates.size())];
  const Eigen::Index d = scaling.ideal.size();
  const auto metric = static_cast<Eigen::Index>(random_.Index(static_cast<std::size_t>(d)));
  return {TrackKind::kGap,
          std::make_unique<LocalOptimization>(
              options, scaling,
              Toward(scaling.Apply(archive[start].metrics), -VectorXd::Unit(d, metric), kFarAway),
              start),
          nullptr};
}

TrackScheduler::Track TrackScheduler::PlanarGapTrack(const Archive& archive,
                                                     const PerformanceBuffer& buffer) {
  const Scaling& scaling = buffer.scaling();
  std::vector<std::pair<VectorXd, std::size_t>> front;
  for (const std::size_t entry : archive.non_dominated()) {
    front.emplace_back(scaling.Apply(archive[entry].metrics), entry);
  }
  std::sort(front.begin(), front.end(),
            [](const auto& a, const auto& b) { return a.first[0] < b.first[0]; });
  std::size_t widest = 0;
  double most = -1;
  for (std::size_t i = 0; i + 1 < front.size(); ++i) {
    const VectorXd middle = 0.5 * (front[i].first + front[i + 1].first);
    const double need =
        (front[i + 1].first - front[i].first).norm() * std::exp2(-TriesAt(buffer, middle));
    if (need > most) {
      most = need;
      widest = i;
    }
  }
  const VectorXd across = front[widest + 1].first - front[widest].first;
  const VectorXd middle = 0.5 * (front[widest].first + front[widest + 1].first);
  ++TriesAt(buffer, middle);
  VectorXd normal(2);
  normal << -std::abs(across[1]), -std::abs(across[0]);
  normal /= std::max(across.norm(), 1e-300);
  const double reach = options_.delta_s * across.norm() + 0.01;
  const std::size_t start = front[widest + random_.Index(2)].second;
  return {TrackKind::kGap,
          std::make_unique<LocalOptimization>(options_.optimization, scaling,
                                              Toward(middle, normal, reach), start),
          nullptr};
}

// For d > 2: of some random rays near known trade-offs, the one farthest from any of them.
TrackScheduler::Track TrackScheduler::GapTrack(const Archive& archive,
                                               const PerformanceBuffer& buffer) {
  const Scaling& scaling = buffer.scaling();
  const Eigen::Index d = scaling.ideal.size();
  Eigen::MatrixXd rays = ScaledFront(archive, scaling);
  const Eigen::RowVectorXd sizes = rays.colwise().norm().cwiseMax(1e-300);
  rays.array().rowwise() /= sizes.array();
  VectorXd chosen;
  Eigen::Index start = 0;
  double most = -1;
  double hole = 0;
  for (int trial = 0; trial < 32; ++trial) {
    const VectorXd ray = random_.UnitVector(d).cwiseAbs();
    Eigen::Index nearest = 0;
    const double least =
        std::sqrt((rays.colwise() - ray).colwise().squaredNorm().minCoeff(&nearest));
    const double need = least * std::exp2(-TriesAt(buffer, ray));
    if (need > most) {
      most = need;
      hole = least;
      chosen = ray;
      start = nearest;
    }
  }
  ++TriesAt(buffer, chosen);
  const std::size_t entry = archive.non_dominated()[static_cast<std::size_t>(start)];
  const double size = scaling.Apply(archive[entry].metrics).norm();
  const double reach = options_.delta_s * std::max(hole, 0.05) * std::max(size, 0.1);
  return {TrackKind::kGap,
          std::make_unique<LocalOptimization>(options_.optimization, scaling,
                                              Toward(chosen * size, -chosen, reach), entry),
          nullptr};
}

std::size_t TrackScheduler::DrawFrontEntry(const Archive& archive,
                                           const PerformanceBuffer& buffer) {
  // Uniformly over cells, as the thesis does; cells whose best point is dominated are passed over.
  const std::size_t count = buffer.cells().size();
  for (int trial = 0; trial < 32; ++trial) {
    const auto cell =
        std::next(buffer.cells().begin(), static_cast<std::ptrdiff_t>(random_.Index(count)));
    const std::size_t entry = cell->second.front().entry;
    if (!archive.ClearlyDominated(archive[entry].metrics, buffer.scaling(), 1e-6)) return entry;
  }
  return archive.non_dominated()[random_.Index(archive.non_dominated().size())];
}

TrackScheduler::Track TrackScheduler::RefineTrack(const Archive& archive,
                                                  const PerformanceBuffer& buffer) {
  const std::size_t start = DrawFrontEntry(archive, buffer);
  const VectorXd y = buffer.scaling().Apply(archive[start].metrics);
  VectorXd direction = Diagonal(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) direction[i] *= 0.2 + random_.Uniform();
  direction.normalize();
  const double reach = 0.5 * options_.delta_s * std::max(y.norm(), 0.1);
  return {TrackKind::kRefine,
          std::make_unique<LocalOptimization>(options_.optimization, buffer.scaling(),
                                              Toward(y, direction, reach), start),
          nullptr};
}

TrackScheduler::Track TrackScheduler::BridgeTrack(const Archive& archive,
                                                  const PerformanceBuffer& buffer) {
  std::vector<VectorXd> points;
  for (Bridge& bridge : bridging_.Next(archive, buffer.scaling(), kBridges, random_)) {
    points.push_back(std::move(bridge.u));
  }
  return {TrackKind::kBridge, nullptr, std::make_unique<PointList>(std::move(points))};
}

TrackScheduler::Track TrackScheduler::Polish(const Archive& archive,
                                             const PerformanceBuffer& buffer) {
  std::vector<VectorXd> points;
  for (const Bridge& bridge : bridging_.Next(archive, buffer.scaling(), kBridges, random_)) {
    points.push_back(Polished(archive, buffer.scaling(), bridge.u, bridge.length).u);
  }
  return {TrackKind::kPolish, nullptr, std::make_unique<PointList>(std::move(points))};
}

TrackScheduler::Track TrackScheduler::AlignTrack(const Archive& archive,
                                                 const PerformanceBuffer& buffer) {
  return {
      TrackKind::kAlign, nullptr,
      std::make_unique<PointList>(AlignedDesigns(archive, buffer.scaling(), kAligned, random_))};
}

TrackScheduler::Track TrackScheduler::SweepTrack(const Archive& archive,
                                                 const PerformanceBuffer& buffer) {
  const std::size_t start = DrawFrontEntry(archive, buffer);
  const VectorXd y = buffer.scaling().Apply(archive[start].metrics);
  const auto parameter =
      static_cast<Eigen::Index>(random_.Index(static_cast<std::size_t>(archive[start].u.size())));
  const Target target = Toward(y, Diagonal(y.size()), options_.delta_s * std::max(y.norm(), 0.1));
  return {TrackKind::kSweep, nullptr,
          std::make_unique<CoordinateSearch>(archive, buffer.scaling(), target, start, parameter,
                                             random_.Uniform() < 0.5 ? kSweepValues : 0, random_)};
}

TrackScheduler::Track TrackScheduler::SampleTrack(const Archive& archive,
                                                  const PerformanceBuffer& buffer) {
  const std::size_t near = DrawFrontEntry(archive, buffer);
  const VectorXd y = buffer.scaling().Apply(archive[near].metrics).cwiseMax(0.0);
  const VectorXd start = PerturbedSample(archive[near].u, options_.delta_p, random_);
  // The ray of a cell within delta_N of the sample's own.
  VectorXd ray = y.norm() > 0 ? VectorXd(y.normalized()) : VectorXd(-Diagonal(y.size()));
  ray += options_.delta_n * random_.UnitVector(y.size());
  ray = ray.cwiseMax(0.0);
  ray = ray.norm() > 0 ? VectorXd(ray.normalized()) : VectorXd(-Diagonal(y.size()));
  const double size = std::max(y.norm(), 0.1);
  LocalOptimization::Options options = options_.optimization;
  options.join = false;
  options.evaluations = static_cast<int>(8 + archive[near].u.size());
  return {TrackKind::kSample,
          std::make_unique<LocalOptimization>(
              options, buffer.scaling(), Toward(ray * size, -ray, options_.delta_s * size), start),
          nullptr};
}

}  // namespace mortise::pareto
