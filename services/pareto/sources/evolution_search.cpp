#include "services/pareto/sources/evolution_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr double kReference = 1.1;      // in scaled performance
constexpr double kFirstSize = 0.03;     // of the Gaussian, unit coordinates
constexpr double kMinSize = 1e-3;       // of those of later searches
constexpr double kMaxSize = 0.15;       // the same
constexpr double kMinReach = 1e-6;      // of a Gaussian that has come to its end
constexpr double kGain = 1e-3;          // of merit, relative, that counts
constexpr double kPatience = 8;         // generations without a gain, with few parameters
constexpr double kPatiencePerSize = 4;  // more, for as many parameters as samples
constexpr std::size_t kStarts = 16;     // trade-offs of which a search starts at the loneliest
constexpr std::size_t kTransferTrials = 4;
constexpr int kCandidates = 4;   // samples of which a model chooses one
constexpr double kWorst = -1e6;  // merit: far below what any performance is worth

// In scaled performance.
double DistanceToNeighbour(const Archive& archive, const Scaling& scaling, std::size_t entry) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t other : archive.non_dominated()) {
    if (other == entry) continue;
    const VectorXd apart = archive[other].metrics - archive[entry].metrics;
    least = std::min(least, apart.cwiseQuotient(scaling.range).norm());
  }
  return least;
}

// In unit coordinates.
double DistanceToNearestDesign(const Archive& archive, std::size_t entry) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t other : archive.non_dominated()) {
    if (other != entry) least = std::min(least, (archive[other].u - archive[entry].u).norm());
  }
  return least;
}

}  // namespace

double EvolutionSearch::MeritOf(const Archive& archive, const Scaling& scaling,
                                std::size_t entry) const {
  const ArchiveEntry& found = archive[entry];
  if (!found.evaluated) return 2 * kWorst;
  if (found.feasible) return MeritOf(scaling, found.metrics);
  const double violation = archive.Violation(entry);
  return kWorst * (1 + violation / (1 + violation));
}

// The improvement of hypervolume over the snapshot; below zero, how far it is from adding any.
double EvolutionSearch::MeritOf(const Scaling& scaling, const VectorXd& metrics) const {
  const VectorXd y = (snapshot_.cols() > 0 ? snapshot_scaling_ : scaling).Apply(metrics);
  const VectorXd reference = VectorXd::Constant(y.size(), kReference);
  double missing = std::max((y - reference).maxCoeff(), 0.0);
  for (Eigen::Index i = 0; i < snapshot_.cols(); ++i) {
    missing = std::max(missing, (y - snapshot_.col(i)).minCoeff());
  }
  if (missing > 0) return -missing;
  std::vector<VectorXd> covered;  // of what is between y and the reference
  for (Eigen::Index i = 0; i < snapshot_.cols(); ++i) {
    covered.push_back(snapshot_.col(i).cwiseMax(y));
  }
  return (reference - y).prod() - Hypervolume(covered, reference);
}

double EvolutionSearch::Patience() const {
  const auto size = static_cast<double>(strategy_->mean().size());
  return kPatience + kPatiencePerSize * size / strategy_->samples();
}

double EvolutionSearch::Promise() const {
  if (searches_ == 0) return 1;
  if (searches_ > 1) return 0;
  return std::max(0.0, 1 - barren_ / Patience());
}

std::size_t EvolutionSearch::FirstStart(const Archive& archive, const Scaling& scaling) const {
  return *std::ranges::max_element(archive.non_dominated(), {}, [&](std::size_t entry) {
    return MeritOf(archive, scaling, entry);
  });
}

std::size_t EvolutionSearch::NextStart(const Archive& archive, const Scaling& scaling) {
  const std::vector<std::size_t>& front = archive.non_dominated();
  std::size_t start = front.front();
  double most = -1;
  for (std::size_t n = 0; n < kStarts; ++n) {
    const std::size_t entry = front[random_.Index(front.size())];
    const double hole = DistanceToNeighbour(archive, scaling, entry);
    if (hole <= most) continue;
    most = hole;
    start = entry;
  }
  return start;
}

void EvolutionSearch::Begin(const Archive& archive, const Scaling& scaling) {
  std::size_t start;
  if (searches_++ == 0) {
    start = FirstStart(archive, scaling);
    strategy_.emplace(archive[start].u, kFirstSize);
  } else {
    snapshot_scaling_ = scaling;
    const std::vector<std::size_t>& front = archive.non_dominated();
    snapshot_.resize(scaling.ideal.size(), static_cast<Eigen::Index>(front.size()));
    for (std::size_t i = 0; i < front.size(); ++i) {
      snapshot_.col(static_cast<Eigen::Index>(i)) = scaling.Apply(archive[front[i]].metrics);
    }
    start = NextStart(archive, scaling);
    const double size = DistanceToNearestDesign(archive, start);
    strategy_->Restart(archive[start].u, std::clamp(size, kMinSize, kMaxSize));
  }
  bests_ = {start};
  generation_.clear();
  model_.reset();
  barren_ = 0;
}

EvolutionSearch::Sample EvolutionSearch::Next(const Archive& archive, const Scaling& scaling) {
  if (!strategy_ || barren_ > Patience() || strategy_->Reach() < kMinReach) {
    Begin(archive, scaling);
  }
  if (!model_) {
    const VectorXd& mean = strategy_->mean();
    const double radius = strategy_->Reach() * std::sqrt(static_cast<double>(mean.size()));
    model_ = FitQuadraticModel(archive, archive.Nearest(mean, 1).front(), radius,
                               archive.PriorJacobian(mean));
  }
  VectorXd chosen = strategy_->Sample(random_);
  double most = MeritOf(scaling, model_->Predict(chosen));
  for (int n = 1; n < kCandidates; ++n) {
    VectorXd u = strategy_->Sample(random_);
    const double merit = MeritOf(scaling, model_->Predict(u));
    if (!(merit > most)) continue;
    most = merit;
    chosen = std::move(u);
  }
  return {std::move(chosen), searches_};
}

void EvolutionSearch::Tell(const Archive& archive, const Scaling& scaling, int search,
                           std::size_t entry) {
  if (search != searches_) return;
  generation_.push_back(entry);
  if (static_cast<int>(generation_.size()) == strategy_->samples()) Learn(archive, scaling);
}

void EvolutionSearch::Learn(const Archive& archive, const Scaling& scaling) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (const std::size_t entry : generation_) {
    ranked.emplace_back(-MeritOf(archive, scaling, entry), entry);
  }
  std::ranges::stable_sort(ranked, {}, [](const auto& one) { return one.first; });
  std::vector<VectorXd> designs;
  for (const auto& [merit, entry] : ranked) designs.push_back(archive[entry].u);
  strategy_->Learn(designs);
  generation_.clear();
  model_.reset();
  const double best = -ranked.front().first, before = MeritOf(archive, scaling, bests_.back());
  ++barren_;
  if (!(best > before)) return;
  if (best > before + kGain * std::abs(before)) barren_ = 0;
  bests_.push_back(ranked.front().second);
}

std::vector<VectorXd> EvolutionSearch::Transfers(const Archive& archive, std::size_t count) {
  std::vector<VectorXd> designs;
  if (bests_.empty()) return designs;
  const std::vector<std::size_t>& front = archive.non_dominated();
  const std::size_t best = bests_.back();
  // Those that were found longest ago have most to gain.
  std::set<std::pair<std::size_t, std::size_t>> candidates;  // what was best then, and trade-off
  for (std::size_t trial = 0; trial < kTransferTrials * count; ++trial) {
    const std::size_t other = front[random_.Index(front.size())];
    const auto later = std::ranges::upper_bound(bests_, other);
    const std::size_t base = later == bests_.begin() ? bests_.front() : *std::prev(later);
    if (base != best && !transferred_.contains({other, best})) candidates.emplace(base, other);
  }
  for (const auto& [base, other] : candidates) {
    if (designs.size() == count) break;
    transferred_.emplace(other, best);
    const VectorXd u = archive[other].u + archive[best].u - archive[base].u;
    designs.push_back(u.cwiseMax(0.0).cwiseMin(1.0));
  }
  return designs;
}

Evolving::Evolving(const Archive& archive, const Scaling& scaling, int samples,
                   EvolutionSearch& search)
    : search_(search) {
  for (int n = 0; n < samples; ++n) samples_.push_back(search.Next(archive, scaling));
}

std::optional<VectorXd> Evolving::Ask(Archive&) {
  if (samples_.empty()) return std::nullopt;
  EvolutionSearch::Sample sample = std::move(samples_.front());
  samples_.pop_front();
  asked_.push_back(sample.search);
  return std::move(sample.u);
}

void Evolving::Tell(Archive& archive, std::size_t entry) {
  const int search = asked_.front();
  asked_.pop_front();
  search_.Tell(archive, archive.CurrentScaling(), search, entry);
}

}  // namespace mortise::pareto
