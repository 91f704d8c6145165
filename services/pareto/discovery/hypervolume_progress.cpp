#include "services/pareto/discovery/hypervolume_progress.h"

#include <vector>

#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

constexpr Eigen::Index kExactMetrics = 4;  // of gains
constexpr std::size_t kMaxOverlaps = 64;   // of gains for more metrics
constexpr std::int64_t kShownEvery = 16;   // shown until there are that part more evaluations

}  // namespace

double DominatedVolume(const Archive& archive, const Scaling& scaling, double reference,
                       HypervolumeSamples samples) {
  std::vector<Eigen::VectorXd> points;
  for (const std::size_t index : archive.non_dominated()) {
    points.push_back(scaling.Apply(archive[index].metrics));
  }
  return QuickHypervolume(points, Eigen::VectorXd::Constant(scaling.ideal.size(), reference),
                          static_cast<int>(samples));
}

double GainedVolume(const Archive& archive, const Scaling& scaling, std::size_t entry) {
  const auto front = archive.non_dominated_metrics();
  const auto others = front.cols() - 1;
  const std::vector<std::size_t>& displaced = archive.displaced();
  Eigen::MatrixXd before(front.rows(), others + std::ssize(displaced));
  before.leftCols(others) = front.leftCols(others);
  for (std::size_t k = 0; k < displaced.size(); ++k) {
    before.col(others + static_cast<Eigen::Index>(k)) = archive[displaced[k]].metrics;
  }
  const double volume = HypervolumeContribution(archive[entry].metrics, before,
                                                scaling.ideal + kRunningReference * scaling.range,
                                                front.rows() <= kExactMetrics ? 0 : kMaxOverlaps);
  return volume / scaling.range.prod();
}

double ShownHypervolume::At(const Archive& archive, std::int64_t evaluations, bool has_finished) {
  const std::int64_t since = evaluations - evaluations_;
  const std::int64_t wanted = has_finished ? 0 : evaluations_ / kShownEvery;
  if (archive.feasible_count() > 0 && since > wanted) {
    evaluations_ = evaluations;
    hypervolume_ =
        DominatedVolume(archive, archive.CurrentScaling(), 1,
                        has_finished ? HypervolumeSamples::kFinal : HypervolumeSamples::kRunning);
  }
  return hypervolume_;
}

}  // namespace mortise::pareto
