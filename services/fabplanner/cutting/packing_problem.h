// States bin packing with equal sizes counted instead of listed, with its lower bound and greedy
// solutions. Internal to bin_packing.
#pragma once

#include <cstdint>
#include <vector>

#include "services/fabplanner/cutting/bin_packing.h"

namespace mortise::fabplanner {

using Counts = std::vector<int>;  // how often each distinct size occurs

// A bin as counts of distinct sizes, used `times` times.
struct Pattern {
  int type = 0;
  Counts counts;
  int64_t filled = 0;
  int times = 1;
};

using Solution = std::vector<Pattern>;

// The problem: distinct sizes, largest first, and how often each occurs.
struct PackingProblem {
  std::vector<int64_t> sizes;
  Counts counts;
  std::vector<BinType> types;
  int cheapest_per_size = 0;  // type with the least cost / capacity
  int64_t largest_capacity = 0;
  int64_t least_cost = 0;

  PackingProblem() = default;
  PackingProblem(const std::vector<int64_t>& all_sizes, const std::vector<BinType>& bin_types);

  int64_t CostOf(const Solution& solution) const;

  // Returns a bound: no packing of the `remaining` items, which add up to `total`, costs less.
  int64_t LowerBound(const Counts& remaining, int64_t total) const;

  // Returns the cheapest type that holds `filled`; -1 if none does.
  int CheapestTypeFor(int64_t filled) const;

  // Returns what all remaining sizes from an index on add up to, for pruning.
  std::vector<int64_t> RestOf(const Counts& remaining) const;
};

// Packs first-fit (or best-fit) decreasing into bins of one type, each of which is then shrunk to
// the cheapest type that holds its items. The solution is empty if an item does not fit the type.
Solution FitDecreasing(const PackingProblem& problem, int type, bool best_fit);

// Packs by minimum bin slack: fills bin after bin as full as possible around the largest item left,
// with at most `steps_per_bin` steps for each, and uses a pattern as often as it goes.
Solution MinimumSlack(const PackingProblem& problem, int64_t steps_per_bin);

}  // namespace mortise::fabplanner
