#include "services/fabplanner/cutting/packing_problem.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace mortise::fabplanner {
namespace {

int64_t CeilDivide(int64_t a, int64_t b) { return (a + b - 1) / b; }

__int128 CeilDivideWide(__int128 a, __int128 b) { return (a + b - 1) / b; }

// Finds the fullest way to fill one bin that contains the largest item left (subset sum with a
// bounded number of steps).
class FullestBin {
 public:
  FullestBin(const PackingProblem& problem, const Counts& remaining, int64_t capacity,
             int64_t steps)
      : problem_(problem),
        remaining_(remaining),
        capacity_(capacity),
        steps_(steps),
        rest_(problem.RestOf(remaining)) {}

  Pattern Find() {
    std::size_t first = 0;
    while (remaining_[first] == 0) ++first;
    current_.assign(problem_.sizes.size(), 0);
    current_[first] = 1;
    best_.counts = current_;
    best_.filled = problem_.sizes[first];
    Extend(first, problem_.sizes[first], remaining_[first] - 1);
    return best_;
  }

 private:
  // Decides how often size `s` (of which `available` are left) joins the bin, then the smaller
  // ones.
  void Extend(std::size_t s, int64_t filled, int available) {
    if (filled > best_.filled) {
      best_.filled = filled;
      best_.counts = current_;
    }
    if (best_.filled == capacity_ || s == problem_.sizes.size() || steps_-- <= 0) return;
    if (filled + rest_[s] <= best_.filled) return;
    const int64_t size = problem_.sizes[s];
    const int most = static_cast<int>(std::min<int64_t>(available, (capacity_ - filled) / size));
    for (int count = most; count >= 0; --count) {
      current_[s] += count;
      const int next = s + 1 < problem_.sizes.size() ? remaining_[s + 1] : 0;
      Extend(s + 1, filled + count * size, next);
      current_[s] -= count;
      if (best_.filled == capacity_ || steps_ <= 0) return;
    }
  }

  const PackingProblem& problem_;
  const Counts& remaining_;
  int64_t capacity_;
  int64_t steps_;
  std::vector<int64_t> rest_;
  Counts current_;
  Pattern best_;
};

}  // namespace

PackingProblem::PackingProblem(const std::vector<int64_t>& all_sizes,
                               const std::vector<BinType>& bin_types)
    : types(bin_types) {
  std::vector<int64_t> sorted = all_sizes;
  std::sort(sorted.rbegin(), sorted.rend());
  for (int64_t size : sorted) {
    if (sizes.empty() || sizes.back() != size) {
      sizes.push_back(size);
      counts.push_back(0);
    }
    ++counts.back();
  }
  least_cost = std::numeric_limits<int64_t>::max();
  for (int t = 0; t < static_cast<int>(types.size()); ++t) {
    const BinType& best = types[cheapest_per_size];
    if (static_cast<__int128>(types[t].cost) * best.capacity <
        static_cast<__int128>(best.cost) * types[t].capacity) {
      cheapest_per_size = t;
    }
    largest_capacity = std::max(largest_capacity, types[t].capacity);
    least_cost = std::min(least_cost, types[t].cost);
  }
}

int64_t PackingProblem::CostOf(const Solution& solution) const {
  int64_t cost = 0;
  for (const Pattern& pattern : solution) cost += types[pattern.type].cost * pattern.times;
  return cost;
}

int64_t PackingProblem::LowerBound(const Counts& remaining, int64_t total) const {
  const BinType& best = types[cheapest_per_size];
  const auto by_size =
      static_cast<int64_t>(CeilDivideWide(static_cast<__int128>(total) * best.cost, best.capacity));
  if (by_size == 0) return 0;
  return std::max(by_size, least_cost * PackingBound(sizes, remaining, largest_capacity));
}

int PackingProblem::CheapestTypeFor(int64_t filled) const {
  int best = -1;
  for (int t = 0; t < static_cast<int>(types.size()); ++t) {
    if (types[t].capacity < filled) continue;
    if (best < 0 || types[t].cost < types[best].cost) best = t;
  }
  return best;
}

std::vector<int64_t> PackingProblem::RestOf(const Counts& remaining) const {
  std::vector<int64_t> rest(sizes.size() + 1, 0);
  for (std::size_t s = sizes.size(); s-- > 0;) rest[s] = rest[s + 1] + sizes[s] * remaining[s];
  return rest;
}

Solution FitDecreasing(const PackingProblem& problem, int type, bool best_fit) {
  const int64_t capacity = problem.types[type].capacity;
  if (problem.sizes.front() > capacity) return {};
  Solution bins;
  for (std::size_t s = 0; s < problem.sizes.size(); ++s) {
    std::size_t first = 0;  // equal items: the bins before this one are too full
    for (int copy = 0; copy < problem.counts[s]; ++copy) {
      std::size_t chosen = bins.size();
      for (std::size_t b = first; b < bins.size(); ++b) {
        if (bins[b].filled + problem.sizes[s] > capacity) continue;
        if (chosen == bins.size() || bins[b].filled > bins[chosen].filled) chosen = b;
        if (!best_fit) break;
      }
      if (chosen == bins.size()) bins.push_back({type, Counts(problem.sizes.size(), 0), 0, 1});
      if (!best_fit) first = chosen;
      ++bins[chosen].counts[s];
      bins[chosen].filled += problem.sizes[s];
    }
  }
  for (Pattern& bin : bins) bin.type = problem.CheapestTypeFor(bin.filled);
  return bins;
}

Solution MinimumSlack(const PackingProblem& problem, int64_t steps_per_bin) {
  Solution solution;
  Counts remaining = problem.counts;
  auto left = std::accumulate(remaining.begin(), remaining.end(), int64_t{0});
  while (left > 0) {
    Pattern best;
    double best_price = std::numeric_limits<double>::infinity();  // cost of a filled unit
    for (int t = 0; t < static_cast<int>(problem.types.size()); ++t) {
      std::size_t first = 0;
      while (remaining[first] == 0) ++first;
      if (problem.sizes[first] > problem.types[t].capacity) continue;
      Pattern pattern =
          FullestBin(problem, remaining, problem.types[t].capacity, steps_per_bin).Find();
      pattern.type = problem.CheapestTypeFor(pattern.filled);
      const double price = static_cast<double>(problem.types[pattern.type].cost) /
                           static_cast<double>(pattern.filled);
      if (price < best_price) {
        best_price = price;
        best = std::move(pattern);
      }
    }
    best.times = std::numeric_limits<int>::max();
    for (std::size_t s = 0; s < remaining.size(); ++s) {
      if (best.counts[s] > 0) best.times = std::min(best.times, remaining[s] / best.counts[s]);
    }
    for (std::size_t s = 0; s < remaining.size(); ++s) {
      remaining[s] -= best.counts[s] * best.times;
      left -= static_cast<int64_t>(best.counts[s]) * best.times;
    }
    solution.push_back(std::move(best));
  }
  return solution;
}

int64_t PackingBound(const std::vector<int64_t>& sizes, const std::vector<int>& counts,
                     int64_t capacity) {
  // For a threshold p: sizes over C - p stand alone; those over C/2 take a bin each and leave room;
  // those from p to C/2 must go into that room or further bins.
  int64_t large = 0, large_total = 0;  // over C/2
  std::size_t half = 0;
  while (half < sizes.size() && 2 * sizes[half] > capacity) {
    large += counts[half];
    large_total += sizes[half] * counts[half];
    ++half;
  }
  int64_t best = large;
  // As p falls, p ≤ s ≤ C/2 grows, and what stands alone (s > C − p) gives back its smallest.
  int64_t medium_total = 0;
  int64_t alone = large, alone_total = large_total;
  std::size_t next_alone = half;
  for (std::size_t s = half; s < sizes.size(); ++s) {
    medium_total += sizes[s] * counts[s];
    const int64_t threshold = sizes[s];
    while (next_alone > 0 && sizes[next_alone - 1] <= capacity - threshold) {
      --next_alone;
      alone -= counts[next_alone];
      alone_total -= sizes[next_alone] * counts[next_alone];
    }
    const int64_t room = (large - alone) * capacity - (large_total - alone_total);
    if (medium_total > room) {
      best = std::max(best, large + CeilDivide(medium_total - room, capacity));
    }
  }
  return best;
}

}  // namespace mortise::fabplanner
