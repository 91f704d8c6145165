// The opening of a discovery: along the parameters one by one, what that tells of them, and who
// waits for whom.
#include <algorithm>
#include <memory>
#include <utility>

#include "services/pareto/discovery/discovery.h"
#include "services/pareto/sources/coordinate_descent.h"
#include "services/pareto/sources/front_bridging.h"
#include "services/pareto/sources/front_traverse.h"
#include "services/pareto/sources/parameter_lines.h"

namespace mortise::pareto {

// Whether to wait for what is under way rather than to begin something else: the opening tracks
// share what they learn, and others would start from designs that are far off. When workers have
// been idle for some time, a piece along a single direction is no longer waited for, and after more
// of it nothing.
bool Discovery::AwaitsOpening() const {
  if (descending_) return true;
  if (!scheduler_.AwaitsOpening(metric_count_)) return false;
  const SearchPolicy::Patience patience = policy_.PatienceAfter(idle_);
  if (patience == SearchPolicy::Patience::kNone) return false;
  return tracks_.HasAny([&](const Track& track) {
    return track.kind == TrackKind::kOpening &&
           (track.patch == nullptr || patience == SearchPolicy::Patience::kAll);
  });
}

// What designs that differ in a single parameter tell of it: mostly those of the descent and of
// traverses. Where a workshop can only set some values, steps stay long enough to reach the next.
void Discovery::LearnFromLines() {
  const Scaling scaling = archive_.CurrentScaling();
  const std::vector<ParameterLine> lines = ParameterLines(archive_);
  Eigen::VectorXd lengths = RelativeLengths(archive_, lines, scaling);
  const Eigen::VectorXd& step = box_.box().step;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    if (step[i] > 0) lengths[i] = 1;
  }
  archive_.UseLengths(std::move(lengths));
  trading_ = TradingParameters(archive_, lines, scaling, SearchPolicy::kMinTrade);
}

// Before each metric's optimum is looked for, which begins from the best known.
void Discovery::TryLeastAlongLines() {
  if (archive_.feasible_count() == 0) return;
  tracks_.Start(std::make_unique<PointList>(LeastAlongLines(archive_, ParameterLines(archive_))),
                TrackKind::kOpening);
}

// From the trade-off nearest to the ideal.
void Discovery::TraverseFromMiddle() {
  if (archive_.feasible_count() == 0) return;
  const Scaling scaling = archive_.CurrentScaling();
  StartTraverses(*std::ranges::min_element(archive_.non_dominated(), {}, [&](std::size_t entry) {
    return scaling.Apply(archive_[entry].metrics).norm();
  }));
}

// Along the parameters that trade metrics off, in turns, as many as a front of so many metrics has
// dimensions. Pieces by gradients are exact and need no help.
void Discovery::StartTraverses(std::size_t entry) {
  if (OffersEvery(archive_[entry].jacobian)) return;
  std::vector<Eigen::Index> parameters = trading_;
  std::ranges::stable_sort(parameters, {}, [&](Eigen::Index i) { return traversed_[i]; });
  parameters.resize(std::min(parameters.size(), static_cast<std::size_t>(metric_count_ - 1)));
  for (const Eigen::Index parameter : parameters) {
    const FrontTraverse::Options options;
    if (!policy_.MayTraverse(traverses_.size(), options.evaluations)) return;
    ++traversed_[parameter];
    const bool is_known = std::ranges::any_of(traverses_, [&](const auto& earlier) {
      Eigen::VectorXd apart = earlier.second - archive_[entry].u;
      apart[parameter] = 0;
      return earlier.first == parameter &&
             apart.lpNorm<Eigen::Infinity>() < SearchPolicy::kSameTraverse;
    });
    if (is_known) continue;
    traverses_.emplace_back(parameter, archive_[entry].u);
    tracks_.Start(
        std::make_unique<FrontTraverse>(options, archive_, buffer_.scaling(), entry, parameter),
        TrackKind::kOpening);
  }
}

// From the design nearest to the ideal; of the space-filling ones where others were given, since
// those may all be in a valley that was the best before.
std::unique_ptr<PointSource> Discovery::MakeDescent() {
  const Scaling scaling = archive_.CurrentScaling();
  std::vector<std::size_t> candidates;
  for (auto entry = static_cast<std::size_t>(given());
       given() > 0 && entry < static_cast<std::size_t>(initial_samples_); ++entry) {
    if (archive_[entry].feasible) candidates.push_back(entry);
  }
  if (candidates.empty()) candidates = archive_.non_dominated();
  const std::size_t start = *std::ranges::min_element(candidates, {}, [&](std::size_t entry) {
    return scaling.Apply(archive_[entry].metrics).norm();
  });
  return std::make_unique<CoordinateDescent>(policy_.Descent(), archive_, start, random_);
}

}  // namespace mortise::pareto
