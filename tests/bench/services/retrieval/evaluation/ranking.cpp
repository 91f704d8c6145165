#include "tests/bench/services/retrieval/evaluation/ranking.h"

#include <algorithm>
#include <cmath>

namespace mortise::retrieval {

std::vector<double> InterpolatedPrecisions(const std::vector<char>& relevant, int count) {
  const auto all = static_cast<double>(std::ranges::count(relevant, 1));
  std::vector<double> interpolated(static_cast<std::size_t>(count), 0.0);
  double found = 0;
  for (std::size_t i = 0; i < relevant.size(); ++i) {
    if (!relevant[i]) continue;
    ++found;
    const double precision = found / static_cast<double>(i + 1);
    // All recalls up to this one.
    const auto last = static_cast<std::size_t>(std::floor(found / all * (count - 1) + 1e-9));
    for (std::size_t at = 0; at <= last; ++at) {
      interpolated[at] = std::max(interpolated[at], precision);
    }
  }
  return interpolated;
}

double FirstTier(const std::vector<char>& relevant) {
  const auto all = std::ranges::count(relevant, 1);
  if (all == 0) return 0;
  return static_cast<double>(std::count(relevant.begin(), relevant.begin() + all, 1)) /
         static_cast<double>(all);
}

}  // namespace mortise::retrieval
