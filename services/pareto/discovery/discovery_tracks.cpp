// The life of the tracks of a discovery: which begins next, and what follows from those that end.
#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "services/pareto/discovery/discovery.h"

namespace mortise::pareto {

void Discovery::StartTrack(bool force_sample, bool polishes) {
  if (!opened_ && OffersGradients()) {
    scheduler_.UseGradients(static_cast<std::size_t>(initial_samples_));
  }
  if (!std::exchange(opened_, true) && policy_.Explores()) {
    descending_ = true;
    tracks_.Start(MakeDescent(), TrackKind::kOpening);
    return;
  }
  if (policy_.Evolves()) scheduler_.Invest(SearchPolicy::kInvestment * evolution_.Promise());
  StartOptimization(force_sample, polishes);
}

// Begins a local optimisation, or what the scheduler wants in its place.
void Discovery::StartOptimization(bool force_sample, bool polishes) {
  TrackScheduler::Track next = polishes ? scheduler_.Polish(archive_, buffer_)
                                        : scheduler_.Next(archive_, buffer_, force_sample);
  constexpr int kChildren = SearchPolicy::kChildren;
  if (next.kind == TrackKind::kBreed) {
    next.other = std::make_unique<Breeding>(archive_, population_, kChildren, random_);
  }
  if (next.kind == TrackKind::kEvolve) {
    next.other =
        std::make_unique<Evolving>(archive_, archive_.CurrentScaling(), kChildren, evolution_);
  }
  if (next.kind == TrackKind::kTransfer) {
    next.other = std::make_unique<PointList>(evolution_.Transfers(archive_, kChildren));
  }
  if (next.other != nullptr) {
    tracks_.Start(std::move(next.other), next.kind);
  } else {
    tracks_.Start(std::move(next.optimization), next.kind);
  }
}

// Begins the next round of the finishing, if one is due.
void Discovery::StartFinishing() {
  if (std::unique_ptr<PointSource> round = finishing_.NextRound(archive_, window_.left())) {
    tracks_.StartFinishing(std::move(round));
  }
}

// While nothing meets the constraints: begins at the design that is nearest to that and was not
// tried yet. Returns false where there is none, or enough are under way.
bool Discovery::StartRestoration() {
  // The first one goes alone: the others go by the slopes that it measures.
  const int most = restored_from_.size() == 1 ? 1 : policy_.RestorationsAtOnce();
  if (static_cast<int>(tracks_.size()) >= most) return false;
  std::optional<std::size_t> start;
  for (std::size_t entry = 0; entry < archive_.size(); ++entry) {
    if (!archive_[entry].evaluated || restored_from_.contains(entry)) continue;
    if (!start || archive_.Violation(entry) < archive_.Violation(*start)) start = entry;
  }
  if (!start) return false;
  restored_from_.insert(*start);
  const Eigen::VectorXd direction = Eigen::VectorXd::Constant(metric_count_, -1).normalized();
  const Scaling scaling = archive_.CurrentScaling();
  const double reach = options_.scheduling.delta_s;
  const LocalOptimization::Target target{
      scaling.Apply(archive_[*start].metrics) + reach * direction, direction, reach};
  tracks_.Start(std::make_unique<LocalOptimization>(policy_.Restoration(restored_from_.size() == 1),
                                                    scaling, target, *start),
                TrackKind::kSample);
  return true;
}

// Begins the first-order expansion round what an optimisation found.
void Discovery::StartExpansion(const Track& of, std::size_t entry) {
  const bool may_probe = policy_.MayProbe(probed_patches_);
  if (may_probe) ++probed_patches_;
  const PatchSampling::Options options =
      policy_.Patch(window_.committed(), may_probe, MayMeasure());
  tracks_.Start(std::make_unique<PatchSampling>(options, buffer_.scaling(), entry), of.kind);
  ++expansions_;
}

void Discovery::RetireFinished() {
  tracks_.RetireFinished([this](const Track& track) { Retire(track); });
}

void Discovery::Retire(const Track& track) {
  scheduler_.Report(track.kind, track.gain, track.evaluations);
  if (track.patch != nullptr) {
    measured_ += track.patch->measurements();
    if (track.patch->piece().directions.cols() > 0) {
      pieces_.push_back(track.patch->piece());
    } else if (track.patch->probes()) {
      --probed_patches_;
    }
  } else if (track.optimization != nullptr) {
    RetireOptimization(track);
  } else if (track.kind == TrackKind::kOpening) {
    RetireOpening(track);
  }
}

// Learns from the descent and from traverses, and goes on from the descent.
void Discovery::RetireOpening(const Track& track) {
  if (track.evaluations > 0) LearnFromLines();
  if (std::exchange(descending_, false)) {
    TryLeastAlongLines();
    TraverseFromMiddle();
  }
}

// Follows the front from what an optimisation found, if that is on it and not on a piece that is
// known.
void Discovery::RetireOptimization(const Track& track) {
  if (track.evaluations > 0) ++optimizations_;
  if (archive_.feasible_count() == 0) return;
  if (!MakesProgress(track)) return;
  const std::optional<std::size_t> best = track.optimization->best();
  if (!best || !archive_[*best].feasible ||
      archive_.ClearlyDominated(archive_[*best].metrics, buffer_.scaling(), options_.delta_b)) {
    return;
  }
  if (track.kind == TrackKind::kOpening) StartTraverses(*best);
  const Eigen::VectorXd& u = archive_[*best].u;
  if (std::any_of(pieces_.begin(), pieces_.end(), [&](const AffinePiece& piece) {
        return (piece.centre - u).lpNorm<Eigen::Infinity>() < SearchPolicy::kSamePiece;
      })) {
    return;
  }
  StartExpansion(track, *best);
}

// Stops the discovery, and returns false, where as many optimisations as are allowed for have ended
// without progress.
bool Discovery::MakesProgress(const Track& track) {
  if (hypervolume_ > progress_mark_ * (1 + options_.delta_i)) {
    progress_mark_ = hypervolume_;
    tracks_since_progress_ = 0;
  } else if (track.evaluations > 0 && ++tracks_since_progress_ == options_.stall_tracks) {
    Stop(StopReason::kConverged,
         absl::StrCat("no progress in ", options_.stall_tracks, " optimisations"));
    return false;
  }
  return true;
}

// Whether a piece's slopes may be measured: differences need values as small as they like.
bool Discovery::MayMeasure() const {
  return policy_.MayMeasure(measured_) && !(box_.box().step.array() > 0).any();
}

// Whether the gradients of all metrics are offered; a slope may be infinite here or there.
bool Discovery::OffersGradients() const {
  return OffersEvery(archive_[archive_.non_dominated().front()].jacobian);
}

bool Discovery::UsesSurrogate() const {
  return policy_.UsesSurrogate(OffersGradients(), window_.proposed());
}

bool Discovery::SurrogateIsDue() const { return turns_.IsDue() && UsesSurrogate(); }

std::optional<TrackPool::Request> Discovery::AskSurrogate() {
  std::vector<Eigen::VectorXd> under_way;
  for (const auto& [number, proposed] : window_.under_way()) under_way.push_back(proposed.origin.u);
  surrogate_track_ = tracks_.Start(surrogate_.Next(archive_, under_way), TrackKind::kSurrogate);
  return tracks_.AskOne(surrogate_track_, archive_, window_.proposed(),
                        [this](const auto& u) { return Find(u); });
}

}  // namespace mortise::pareto
