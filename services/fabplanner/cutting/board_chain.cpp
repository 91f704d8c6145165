#include "services/fabplanner/cutting/board_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::fabplanner {
namespace {

constexpr double kUnitsPerMetre = 1e9;
constexpr int64_t kMostSteps = 2000000;  // of the exact search for one chain
constexpr int64_t kNever = std::numeric_limits<int64_t>::max() / 4;

// Rounded up: what is a nanometre too long is no fault.
int64_t ToUnits(double metres) {
  return static_cast<int64_t>(std::ceil(metres * kUnitsPerMetre - 1e-3));
}

// A way to a state of the search: so many of each kind placed, and the end that they leave.
struct Step {
  int64_t extra = kNever;
  int before = -1;  // end that the part was put to; -1 for the front of the board
  ChainLink link;
};

// The search's states: counts in mixed radix, and the end they leave as an index.
struct States {
  explicit States(const std::vector<std::pair<int, int>>& counts) {
    for (const auto& [kind, count] : counts) {
      strides.push_back(total);
      total *= count + 1;
    }
  }
  int Placed(int64_t state, std::size_t i, int count) const {
    return static_cast<int>(state / strides[i] % (count + 1));
  }

  std::vector<int64_t> strides;
  int64_t total = 1;
};

std::vector<int> RearsOf(const std::vector<LaidWays>& kinds,
                         const std::vector<std::pair<int, int>>& counts) {
  std::vector<int> rears;
  for (const auto& [kind, count] : counts) {
    for (const LaidEnds& ends : kinds[static_cast<std::size_t>(kind)]) rears.push_back(ends.rear);
  }
  std::sort(rears.begin(), rears.end());
  rears.erase(std::unique(rears.begin(), rears.end()), rears.end());
  return rears;
}

// Steps that the exact search would make; more than an int64_t holds are told as kNever.
int64_t StepsFor(const std::vector<LaidWays>& kinds,
                 const std::vector<std::pair<int, int>>& counts) {
  double steps = 4.0 * static_cast<double>(counts.size() * RearsOf(kinds, counts).size());
  for (const auto& [kind, count] : counts) steps *= count + 1;
  return steps < 1e15 ? static_cast<int64_t>(steps) : kNever;
}

}  // namespace

EndClasses::EndClasses(const Eigen::Vector2d& section, double kerf)
    : section_(section), kerf_(kerf), square_kerf_(ToUnits(kerf)) {}

int EndClasses::Of(const EndSlope& slope) {
  const Eigen::Vector2d rise(slope.across * section_.x(), slope.through * section_.y());
  const auto cell = [](double value) -> int64_t { return std::llround(value / kEndTolerance); };
  for (int64_t i = -1; i <= 1; ++i) {
    for (int64_t j = -1; j <= 1; ++j) {
      const auto near = by_cell_.find({cell(rise.x()) + i, cell(rise.y()) + j});
      if (near == by_cell_.end()) continue;
      for (const int end : near->second) {
        const Eigen::Vector2d off = ends_[static_cast<std::size_t>(end)].rise - rise;
        if (off.cwiseAbs().maxCoeff() > kEndTolerance) continue;
        const int64_t kerf = ToUnits(KerfAlong(slope, kerf_));
        error_ = std::max({error_, ToUnits(off.cwiseAbs().sum() / 2),
                           std::abs(kerf - ends_[static_cast<std::size_t>(end)].kerf)});
        return end;
      }
    }
  }
  const int end = static_cast<int>(ends_.size());
  by_cell_[{cell(rise.x()), cell(rise.y())}].push_back(end);
  ends_.push_back({rise, ToUnits(ReachOf(slope, section_)), ToUnits(KerfAlong(slope, kerf_))});
  return end;
}

int64_t EndClasses::ReachOfEnd(const EndSlope& slope) const {
  return ToUnits(mortise::fabplanner::ReachOf(slope, section_));
}

int64_t EndClasses::Gap(int rear, int front) const {
  const End& s = ends_[static_cast<std::size_t>(rear)];
  const End& t = ends_[static_cast<std::size_t>(front)];
  if (rear == front) return s.kerf;
  const int64_t wedge = ToUnits((s.rise - t.rise).cwiseAbs().sum() / 2) + std::min(s.kerf, t.kerf);
  return std::min(wedge, s.reach + t.reach + square_kerf_);
}

CutEnds Laid(const CutEnds& ends, int way) {
  switch (way) {
    case 1:
      return TurnedAboutLength(ends);
    case 2:
      return TurnedAboutWidth(ends);
    case 3:
      return TurnedAboutThickness(ends);
    default:
      return ends;
  }
}

const Chain& ChainFinder::ChainOf(const std::vector<std::pair<int, int>>& counts) {
  const auto [entry, is_new] = known_.try_emplace(counts);
  if (!is_new) return entry->second;
  const int64_t steps = StepsFor(kinds_, counts);
  if (steps <= std::min(kMostSteps, work_)) {
    work_ -= steps;
    entry->second = Shortest(counts);
  } else {
    entry->second = Inserted(counts);
  }
  return entry->second;
}

int64_t ChainFinder::ExtraOf(const std::vector<ChainLink>& links) const {
  int64_t extra =
      classes_.Reach(EndsOf(links.front()).front) + classes_.Reach(EndsOf(links.back()).rear);
  for (std::size_t i = 1; i < links.size(); ++i) {
    extra += classes_.Gap(EndsOf(links[i - 1]).rear, EndsOf(links[i]).front);
  }
  return extra;
}

Chain ChainFinder::Shortest(const std::vector<std::pair<int, int>>& counts) const {
  const States states(counts);
  const std::vector<int> rears = RearsOf(kinds_, counts);
  const auto index_of = [&](int rear) {
    return static_cast<int>(std::lower_bound(rears.begin(), rears.end(), rear) - rears.begin());
  };
  const auto ends = static_cast<int64_t>(rears.size());
  std::vector<Step> steps(static_cast<std::size_t>(states.total * ends));
  const auto extend = [&](int64_t state, int before, int64_t extra) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto [kind, count] = counts[i];
      if (states.Placed(state, i, count) == count) continue;
      for (int way = 0; way < 4; ++way) {
        const LaidEnds& laid = EndsOf({kind, way});
        const int64_t added =
            before < 0 ? classes_.Reach(laid.front)
                       : classes_.Gap(rears[static_cast<std::size_t>(before)], laid.front);
        Step& step = steps[static_cast<std::size_t>((state + states.strides[i]) * ends +
                                                    index_of(laid.rear))];
        if (extra + added < step.extra) step = {extra + added, before, {kind, way}};
      }
    }
  };
  extend(0, -1, 0);
  for (int64_t state = 1; state < states.total; ++state) {
    for (int end = 0; end < ends; ++end) {
      const int64_t extra = steps[static_cast<std::size_t>(state * ends + end)].extra;
      if (extra < kNever) extend(state, end, extra);
    }
  }

  Chain chain{{}, kNever};
  int end = 0;
  int64_t state = states.total - 1;
  for (int last = 0; last < ends; ++last) {
    const int64_t extra = steps[static_cast<std::size_t>(state * ends + last)].extra +
                          classes_.Reach(rears[static_cast<std::size_t>(last)]);
    if (extra >= chain.extra) continue;
    chain.extra = extra;
    end = last;
  }
  while (end >= 0) {
    const Step& step = steps[static_cast<std::size_t>(state * ends + end)];
    chain.links.push_back(step.link);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i].first == step.link.kind) state -= states.strides[i];
    }
    end = step.before;
  }
  std::reverse(chain.links.begin(), chain.links.end());
  return chain;
}

Chain ChainFinder::Inserted(const std::vector<std::pair<int, int>>& counts) const {
  Chain chain;
  // What inserting a link at a place adds; at either end of the chain the reach changes, too.
  const auto added = [&](const ChainLink& link, std::size_t at) -> int64_t {
    const LaidEnds& laid = EndsOf(link);
    const bool first = at == 0, last = at == chain.links.size();
    int64_t change = first ? classes_.Reach(laid.front)
                           : classes_.Gap(EndsOf(chain.links[at - 1]).rear, laid.front);
    change +=
        last ? classes_.Reach(laid.rear) : classes_.Gap(laid.rear, EndsOf(chain.links[at]).front);
    if (first && last) return change;
    if (first) return change - classes_.Reach(EndsOf(chain.links.front()).front);
    if (last) return change - classes_.Reach(EndsOf(chain.links.back()).rear);
    return change - classes_.Gap(EndsOf(chain.links[at - 1]).rear, EndsOf(chain.links[at]).front);
  };
  for (const auto& [kind, count] : counts) {
    for (int i = 0; i < count; ++i) {
      int64_t least = kNever;
      std::size_t place = 0;
      ChainLink chosen;
      for (std::size_t at = 0; at <= chain.links.size(); ++at) {
        for (int way = 0; way < 4; ++way) {
          const int64_t change = added({kind, way}, at);
          if (change >= least) continue;
          least = change;
          place = at;
          chosen = {kind, way};
        }
      }
      chain.links.insert(chain.links.begin() + static_cast<std::ptrdiff_t>(place), chosen);
    }
  }
  chain.extra = ExtraOf(chain.links);
  return chain;
}

}  // namespace mortise::fabplanner
