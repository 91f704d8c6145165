#include "tests/bench/pareto/benchmark_run.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/discovery/combined_discovery.h"

namespace mortise::pareto {
namespace {

using Clock = std::chrono::steady_clock;

// How often is told how far it is.
constexpr std::int64_t kReports = 100;
constexpr int kSamples = 1 << 19;  // of the hypervolume of many points of five or six metrics

}  // namespace

absl::StatusOr<BenchmarkResult> RunBenchmark(
    const BenchmarkProblem& problem, const Discovery::Options& options, bool gradients,
    const std::function<void(const Discovery::Summary&)>& progress,
    const std::function<bool()>& cancelled) {
  Discovery::Options constrained = options;
  constrained.constraints = problem.constraint_count;
  std::vector<DiscreteParameter> discrete;
  if (!problem.rounded) {
    discrete = WithWholeNumbers(problem.space, problem.choices, options.evaluations);
  }
  MORTISE_ASSIGN_OR_RETURN(const auto discovery, MakeDiscovery(problem.space, discrete,
                                                               problem.metric_count, constrained));
  BenchmarkResult result;
  std::vector<Eigen::VectorXd> designs;
  double evaluating = 0;
  const Clock::time_point begin = Clock::now();
  const std::int64_t between = std::max<std::int64_t>(1, options.evaluations / kReports);
  while (!discovery->Finished()) {
    const std::optional<Discovery::Proposal> proposal = discovery->Ask();
    if (!proposal) continue;  // that was the end
    const Clock::time_point asked = Clock::now();
    Evaluation evaluation = problem.evaluate(proposal->x, gradients);
    ++result.evaluations;
    designs.push_back(proposal->x);
    evaluating += SecondsSince(asked);
    MORTISE_RETURN_IF_ERROR(discovery->Tell(proposal->number, std::move(evaluation)));
    if (result.evaluations % between != 0) continue;
    if (progress) progress(discovery->summary());
    if (cancelled && cancelled()) discovery->Stop(Discovery::StopReason::kCancelled, "cancelled");
  }
  result.own_seconds = SecondsSince(begin) - evaluating;
  result.summary = discovery->summary();
  result.front = discovery->front();
  std::vector<Eigen::VectorXd> points;
  for (const std::size_t entry : discovery->archive().non_dominated()) {
    const ArchiveEntry& found = discovery->archive()[entry];
    // Entries have the numbers of their proposals.
    result.non_dominated.push_back({designs[entry], found.metrics, found.constraints});
    points.push_back(found.metrics);
  }
  std::ranges::sort(result.non_dominated, {}, [](const BenchmarkPoint& point) {
    return std::vector<double>(point.metrics.begin(), point.metrics.end());
  });
  result.hypervolume = QuickHypervolume(points, problem.reference, kSamples);
  return result;
}

}  // namespace mortise::pareto
