#include "services/pareto/sources/front_bridging.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kSources = 24;        // trade-offs looked at, at random
constexpr Eigen::Index kMaxNeighbours = 6;  // of each

struct Candidate {
  double hole = 0;  // squared distance to the nearest trade-off, scaled performance
  std::tuple<std::size_t, std::size_t, bool> pair;
  Bridge bridge;
};

// The squared distances from `y` to columns of `front`, with their indices, the nearest `count`
// first.
std::vector<std::pair<double, std::size_t>> NearestTo(const VectorXd& y, const MatrixXd& front,
                                                      std::size_t count) {
  const Eigen::RowVectorXd distances = (front.colwise() - y).colwise().squaredNorm();
  std::vector<std::pair<double, std::size_t>> nearest;
  nearest.reserve(static_cast<std::size_t>(distances.size()));
  for (Eigen::Index i = 0; i < distances.size(); ++i) {
    nearest.emplace_back(distances[i], static_cast<std::size_t>(i));
  }
  count = std::min(count, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                    nearest.end());
  nearest.resize(count);
  return nearest;
}

double HoleAt(const VectorXd& y, const MatrixXd& front) {
  return (front.colwise() - y).colwise().squaredNorm().minCoeff();
}

}  // namespace

std::vector<Bridge> FrontBridging::Next(const Archive& archive, const Scaling& scaling,
                                        std::size_t count, Random& random) {
  const std::vector<std::size_t>& entries = archive.non_dominated();
  const MatrixXd front = ScaledFront(archive, scaling);
  const auto neighbours = static_cast<std::size_t>(
      std::min<Eigen::Index>(2 * (scaling.ideal.size() - 1), kMaxNeighbours));
  std::vector<Candidate> candidates;
  for (std::size_t n = 0; n < kSources && entries.size() > 1; ++n) {
    const std::size_t a = random.Index(entries.size());
    const VectorXd here = front.col(static_cast<Eigen::Index>(a));
    for (const auto& [squared, b] : NearestTo(here, front, neighbours + 1)) {
      if (a == b) continue;
      const VectorXd there = front.col(static_cast<Eigen::Index>(b));
      const VectorXd &from = archive[entries[a]].u, &to = archive[entries[b]].u;
      const VectorXd between = 0.5 * (here + there), beyond = 1.5 * here - 0.5 * there;
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
