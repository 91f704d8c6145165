#include "services/fabplanner/cutting/bin_completion.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace mortise::fabplanner {
namespace {

class BinCompletion {
 public:
  BinCompletion(const PackingProblem& problem, Solution* best, int64_t lower_bound, int64_t steps)
      : problem_(problem),
        best_(best),
        best_cost_(problem.CostOf(*best)),
        lower_bound_(lower_bound),
        steps_(steps) {}

  // Improves `best`; true if it is then proven to be the cheapest.
  bool Run() {
    int64_t total = 0;
    for (std::size_t s = 0; s < problem_.sizes.size(); ++s) {
      total += problem_.sizes[s] * problem_.counts[s];
    }
    Counts remaining = problem_.counts;
    Search(remaining, total, 0);
    return best_cost_ == lower_bound_ || (steps_ > 0 && !truncated_);
  }

 private:
  // Collects the completions of one bin, none of which could take another item.
  struct Enumeration {
    const Counts& remaining;
    int type;
    int64_t least_filled;  // emptier bins cannot lead to something better
    Counts current;
    std::vector<int64_t> rest;  // what all sizes from an index on add up to
    std::vector<Pattern>* patterns;
  };

  void Search(Counts& remaining, int64_t total, int64_t cost) {
    if (total == 0) {
      best_cost_ = cost;
      *best_ = path_;
      return;
    }
    if (cost + problem_.LowerBound(remaining, total) >= best_cost_) return;
    for (const Pattern& pattern : Completions(remaining, total, cost)) {
      const int64_t next_cost = cost + problem_.types[pattern.type].cost;
      for (std::size_t s = 0; s < remaining.size(); ++s) remaining[s] -= pattern.counts[s];
      path_.push_back(pattern);
      Search(remaining, total - pattern.filled, next_cost);
      path_.pop_back();
      for (std::size_t s = 0; s < remaining.size(); ++s) remaining[s] += pattern.counts[s];
      if (steps_ <= 0 || best_cost_ == lower_bound_) return;
    }
  }

  std::vector<Pattern> Completions(const Counts& remaining, int64_t total, int64_t cost) {
    std::vector<Pattern> patterns;
    std::size_t first = 0;
    while (remaining[first] == 0) ++first;
    const BinType& cheapest = problem_.types[problem_.cheapest_per_size];
    for (int t = 0; t < static_cast<int>(problem_.types.size()); ++t) {
      const BinType& type = problem_.types[t];
      if (problem_.sizes[first] > type.capacity) continue;
      // What is left after this bin must be affordable at the best price there is.
      const int64_t budget = best_cost_ - 1 - cost - type.cost;
      if (budget < 0) continue;
      const auto affordable = static_cast<int64_t>(std::min<__int128>(
          static_cast<__int128>(budget) * cheapest.capacity / cheapest.cost, total));
      Enumeration enumeration{remaining,
                              t,
                              total - affordable,
                              Counts(problem_.sizes.size(), 0),
                              problem_.RestOf(remaining),
                              &patterns};
      enumeration.current[first] = 1;
      Enumerate(enumeration, first, problem_.sizes[first], remaining[first] - 1,
                std::numeric_limits<int64_t>::max());
    }
    std::stable_sort(patterns.begin(), patterns.end(), [&](const Pattern& a, const Pattern& b) {
      return SlackCost(a) < SlackCost(b);
    });
    return patterns;
  }

  // What a bin costs beyond its contents at the best price.
  double SlackCost(const Pattern& pattern) const {
    const BinType& cheapest = problem_.types[problem_.cheapest_per_size];
    return static_cast<double>(problem_.types[pattern.type].cost) -
           static_cast<double>(pattern.filled) * static_cast<double>(cheapest.cost) /
               static_cast<double>(cheapest.capacity);
  }

  // `smallest_left_out`: the smallest size of which not all that remain are in the bin.
  void Enumerate(Enumeration& e, std::size_t s, int64_t filled, int available,
                 int64_t smallest_left_out) {
    const int64_t capacity = problem_.types[e.type].capacity;
    if (filled + e.rest[s] < e.least_filled || steps_-- <= 0) return;
    if (e.patterns->size() >= kMaxPatterns) {
      truncated_ = true;
      return;
    }
    if (s == problem_.sizes.size()) {
      if (filled < e.least_filled || capacity - filled >= smallest_left_out) return;
      e.patterns->push_back({e.type, e.current, filled, 1});
      return;
    }
    const int64_t size = problem_.sizes[s];
    const int most = static_cast<int>(std::min<int64_t>(available, (capacity - filled) / size));
    for (int count = most; count >= 0; --count) {
      const int64_t left_out = count < available ? size : smallest_left_out;
      e.current[s] += count;
      const int next = s + 1 < problem_.sizes.size() ? e.remaining[s + 1] : 0;
      Enumerate(e, s + 1, filled + count * size, next, left_out);
      e.current[s] -= count;
    }
  }

  static constexpr std::size_t kMaxPatterns = 20000;  // in one node, to bound memory

  const PackingProblem& problem_;
  Solution* best_;
  int64_t best_cost_;
  int64_t lower_bound_;
  int64_t steps_;
  bool truncated_ = false;
  Solution path_;
};

}  // namespace

bool CompleteBins(const PackingProblem& problem, int64_t lower_bound, int64_t steps,
                  Solution* best) {
  return BinCompletion(problem, best, lower_bound, steps).Run();
}

}  // namespace mortise::fabplanner
