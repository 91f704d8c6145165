// Ends, and parts of cells.
#include "services/pareto/archive/front_places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace mortise::pareto {
namespace {

using Candidate = PerformanceBuffer::Candidate;
using CellId = PerformanceBuffer::CellId;

bool LexicographicallyLess(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::ranges::lexicographical_compare(a, b);
}

// The trade-offs of each cell, nearest to the ideal first.
std::map<CellId, std::vector<Candidate>> TradeOffsByCell(const Archive& archive,
                                                         const PerformanceBuffer& buffer) {
  std::map<CellId, std::vector<Candidate>> cells;
  for (const std::size_t entry : archive.non_dominated()) {
    const Eigen::VectorXd scaled = buffer.scaling().Apply(archive[entry].metrics);
    cells[buffer.CellOf(scaled)].push_back({entry, scaled.cwiseMax(0.0).norm()});
  }
  for (auto& [cell, members] : cells) std::ranges::stable_sort(members, {}, &Candidate::distance);
  return cells;
}

// What the buffer keeps of a cell behind its nearest trade-off, but for the ends.
void AddWhatMayStandForIt(const PerformanceBuffer& buffer, const std::set<std::size_t>& ends,
                          FrontPlace& place) {
  const auto kept = buffer.cells().find(place.cell);
  if (kept == buffer.cells().end()) return;
  const std::size_t first = place.candidates.front().entry;
  const auto at = std::ranges::find(kept->second, first, &Candidate::entry);
  if (at == kept->second.end()) return;
  std::copy_if(std::next(at), kept->second.end(), std::back_inserter(place.candidates),
               [&](const Candidate& candidate) { return !ends.contains(candidate.entry); });
}

}  // namespace

std::vector<std::size_t> EndsOfFront(const Archive& archive) {
  if (archive.non_dominated().empty()) return {};
  std::set<std::size_t> ends;
  const auto is_before = [&](Eigen::Index metric, double sign, std::size_t a, std::size_t b) {
    const Eigen::VectorXd &of_a = archive[a].metrics, &of_b = archive[b].metrics;
    if (of_a[metric] != of_b[metric]) return sign * of_a[metric] < sign * of_b[metric];
    return LexicographicallyLess(of_a, of_b);
  };
  const Eigen::Index d = archive[archive.non_dominated().front()].metrics.size();
  for (Eigen::Index metric = 0; metric < d; ++metric) {
    for (const double sign : {1.0, -1.0}) {
      ends.insert(*std::ranges::min_element(
          archive.non_dominated(),
          [&](std::size_t a, std::size_t b) { return is_before(metric, sign, a, b); }));
    }
  }
  return {ends.begin(), ends.end()};
}

std::vector<FrontPlace> PlacesOfFront(const Archive& archive, const PerformanceBuffer& buffer) {
  const std::vector<std::size_t> listed = EndsOfFront(archive);
  const std::set<std::size_t> ends(listed.begin(), listed.end());
  // How wide a cell is from corner to corner, for each unit of distance from the ideal.
  const auto angles = static_cast<double>(buffer.metric_count() - 1);
  const double width = std::numbers::pi / 2 / buffer.cells_per_angle() * std::sqrt(angles);
  std::vector<FrontPlace> places;
  for (const auto& [cell, members] : TradeOffsByCell(archive, buffer)) {
    double covered = -1;  // distances up to which there is a place already
    for (const Candidate& member : members) {
      const bool is_end = ends.contains(member.entry);
      if (member.distance <= covered && !is_end) continue;
      const bool is_nearest = covered < 0;
      covered = member.distance + std::max(buffer.tolerance(), width * member.distance);
      FrontPlace& place = places.emplace_back(FrontPlace{cell, {member}});
      if (is_nearest && !is_end) AddWhatMayStandForIt(buffer, ends, place);
    }
  }
  return places;
}

}  // namespace mortise::pareto
