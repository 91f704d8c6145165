// Non-dominated filtering by a sweep in lexicographic order.
#include "services/pareto/archive/non_dominated.h"

#include <algorithm>
#include <numeric>

namespace mortise::pareto {

bool Dominates(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  bool better = false;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (a[i] > b[i]) return false;
    better = better || a[i] < b[i];
  }
  return better;
}

std::vector<std::size_t> NonDominated(const std::vector<Eigen::VectorXd>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::lexicographical_compare(points[a].begin(), points[a].end(), points[b].begin(),
                                        points[b].end());
  });
  // A point can only be dominated by one that comes before it in lexicographic order.
  std::vector<std::size_t> kept;
  for (const std::size_t candidate : order) {
    const bool covered = std::any_of(kept.rbegin(), kept.rend(), [&](std::size_t other) {
      return points[other] == points[candidate] || Dominates(points[other], points[candidate]);
    });
    if (!covered) kept.push_back(candidate);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace mortise::pareto
