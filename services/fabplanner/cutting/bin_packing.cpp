#include "services/fabplanner/cutting/bin_packing.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "services/fabplanner/cutting/bin_completion.h"
#include "services/fabplanner/cutting/packing_problem.h"

namespace mortise::fabplanner {
namespace {

// Gives the counted patterns their items.
std::vector<PackedBin> Unfold(const PackingProblem& problem, const std::vector<int64_t>& sizes,
                              const Solution& solution) {
  std::vector<int> order(sizes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return sizes[a] > sizes[b]; });
  std::vector<std::size_t> next(problem.sizes.size(), 0);  // next item of each distinct size
  for (std::size_t s = 1; s < next.size(); ++s) next[s] = next[s - 1] + problem.counts[s - 1];
  std::vector<PackedBin> bins;
  for (const Pattern& pattern : solution) {
    for (int time = 0; time < pattern.times; ++time) {
      PackedBin& bin = bins.emplace_back();
      bin.type = pattern.type;
      for (std::size_t s = 0; s < pattern.counts.size(); ++s) {
        for (int i = 0; i < pattern.counts[s]; ++i) bin.items.push_back(order[next[s]++]);
      }
    }
  }
  return bins;
}

}  // namespace

Packing PackBins(const std::vector<int64_t>& sizes, const std::vector<BinType>& types,
                 int64_t search_steps) {
  Packing packing;
  if (sizes.empty()) {
    packing.optimal = true;
    return packing;
  }
  const PackingProblem problem(sizes, types);
  const int64_t total = std::accumulate(sizes.begin(), sizes.end(), int64_t{0});
  packing.lower_bound = problem.LowerBound(problem.counts, total);

  // A fuller bin is not always the better one for the rest: try several degrees of zeal.
  Solution best = MinimumSlack(problem, 100);
  for (int64_t steps_per_bin : {int64_t{3000}, search_steps / 100}) {
    Solution candidate = MinimumSlack(problem, steps_per_bin);
    if (problem.CostOf(candidate) < problem.CostOf(best)) best = std::move(candidate);
  }
  for (int t = 0; t < static_cast<int>(types.size()); ++t) {
    for (bool best_fit : {false, true}) {
      Solution candidate = FitDecreasing(problem, t, best_fit);
      if (!candidate.empty() && problem.CostOf(candidate) < problem.CostOf(best)) {
        best = std::move(candidate);
      }
    }
  }
  packing.optimal = problem.CostOf(best) == packing.lower_bound;
  if (!packing.optimal) {
    packing.optimal = CompleteBins(problem, packing.lower_bound, search_steps, &best);
  }
  packing.cost = problem.CostOf(best);
  if (packing.optimal) packing.lower_bound = packing.cost;
  packing.bins = Unfold(problem, sizes, best);
  return packing;
}

}  // namespace mortise::fabplanner
