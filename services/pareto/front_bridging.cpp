#include "services/pareto/front_bridging.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kSources = 24;  // trade-offs looked at, at random

struct Candidate {
  double hole = 0;  // squared distance to the nearest trade-off, scaled performance
  std::tuple<std::size_t, std::size_t, bool> pair;
  Bridge bridge;
};

// The distances from `y` to all of `front`, with their indices, the nearest `count` first.
std::vector<std::pair<double, std::size_t>> NearestTo(const VectorXd& y,
                                                      const std::vector<VectorXd>& front,
                                                      std::size_t count) {
  std::vector<std::pair<double, std::size_t>> nearest;
  nearest.reserve(front.size());
  for (std::size_t i = 0; i < front.size(); ++i)
    nearest.emplace_back((front[i] - y).squaredNorm(), i);
  count = std::min(count, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                    nearest.end());
  nearest.resize(count);
  return nearest;
}

double HoleAt(const VectorXd& y, const std::vector<VectorXd>& front) {
  return NearestTo(y, front, 1).front().first;
}

}  // namespace

std::vector<Bridge> FrontBridging::Next(const Archive& archive, const Scaling& scaling,
                                        std::size_t count, Random& random) {
  const std::vector<std::size_t>& entries = archive.non_dominated();
  std::vector<VectorXd> front;
  for (const std::size_t entry : entries) front.push_back(scaling.Apply(archive[entry].metrics));
  const auto neighbours = static_cast<std::size_t>(2 * (scaling.ideal.size() - 1));
  std::vector<Candidate> candidates;
  for (std::size_t n = 0; n < kSources && front.size() > 1; ++n) {
    const std::size_t a = random.Index(front.size());
    for (const auto& [squared, b] : NearestTo(front[a], front, neighbours + 1)) {
      if (a == b) continue;
      const VectorXd &from = archive[entries[a]].u, &to = archive[entries[b]].u;
      const VectorXd between = 0.5 * (front[a] + front[b]),
                     beyond = 1.5 * front[a] - 0.5 * front[b];
      const auto [first, second] = std::minmax(entries[a], entries[b]);
      const double length = 0.5 * (from - to).norm();
      candidates.push_back(
          {HoleAt(between, front), {first, second, false}, {0.5 * (from + to), length}});
      candidates.push_back({HoleAt(beyond, front),
                            {entries[a], entries[b], true},
                            {(1.5 * from - 0.5 * to).cwiseMax(0.0).cwiseMin(1.0), length}});
    }
  }
  std::ranges::stable_sort(candidates, std::greater<>{}, &Candidate::hole);
  std::vector<Bridge> bridges;
  for (const Candidate& candidate : candidates) {
    if (bridges.size() == count) break;
    if (tried_.insert(candidate.pair).second) bridges.push_back(candidate.bridge);
  }
  return bridges;
}

std::optional<VectorXd> PointList::Ask(Archive&) {
  if (points_.empty()) return std::nullopt;
  VectorXd point = points_.front();
  points_.pop_front();
  ++outstanding_;
  return point;
}

void PointList::Tell(Archive&, std::size_t) { --outstanding_; }

}  // namespace mortise::pareto
