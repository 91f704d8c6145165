#include "services/fabplanner/joining/taking_apart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

namespace mortise::fabplanner {
namespace {

std::vector<int> Without(const std::vector<int>& units, const std::vector<int>& removed) {
  std::vector<int> rest;
  std::set_difference(units.begin(), units.end(), removed.begin(), removed.end(),
                      std::back_inserter(rest));
  return rest;
}

// How many links each unit is away from the first; those that are not linked to it are missing.
std::map<int, int> HopsFrom(int first, const std::vector<int>& units, const Links& linked) {
  std::map<int, int> hops = {{first, 0}};
  std::vector<int> reached = {first};
  for (std::size_t next = 0; next < reached.size(); ++next) {
    for (int unit : units) {
      if (linked[reached[next]][unit] && hops.emplace(unit, hops[reached[next]] + 1).second) {
        reached.push_back(unit);
      }
    }
  }
  return hops;
}

// By unit: whether the others of its piece would fall into several without it (Tarjan's depth-first
// search, O(units²)).
std::vector<bool> CutUnits(const std::vector<int>& units, const Links& links) {
  struct Visit {
    int unit;
    std::size_t next = 0;
  };
  std::vector<int> order(links.size(), 0), low(links.size(), 0), parent(links.size(), -1);
  std::vector<bool> cut(links.size(), false);
  int visited = 0;
  for (int root : units) {
    if (order[root] > 0) continue;
    int branches = 0;
    std::vector<Visit> path = {{root}};
    order[root] = low[root] = ++visited;
    while (!path.empty()) {
      const int unit = path.back().unit;
      if (path.back().next < units.size()) {
        const int other = units[path.back().next++];
        if (other == unit || !links[unit][other]) continue;
        if (order[other] > 0) {
          if (other != parent[unit]) low[unit] = std::min(low[unit], order[other]);
          continue;
        }
        parent[other] = unit;
        order[other] = low[other] = ++visited;
        path.push_back({other});
        continue;
      }
      path.pop_back();
      const int above = parent[unit];
      if (above < 0) continue;
      low[above] = std::min(low[above], low[unit]);
      if (above == root) {
        ++branches;
      } else if (low[unit] >= order[above]) {
        cut[above] = true;
      }
    }
    cut[root] = branches > 1;
  }
  return cut;
}

int64_t Millimetre(double metres) { return std::llround(metres * 1000); }

// The highest priority of units; 0 if none has one.
int HighestPriority(const std::vector<int>& units, const std::vector<UnitFacts>& facts) {
  int highest = 0;
  for (int unit : units) highest = std::max(highest, facts[unit].priority);
  return highest;
}

// The lowest that one has; as high as can be if none has one.
int LowestPriority(const std::vector<int>& units, const std::vector<UnitFacts>& facts) {
  int lowest = std::numeric_limits<int>::max();
  for (int unit : units) {
    if (facts[unit].priority > 0) lowest = std::min(lowest, facts[unit].priority);
  }
  return lowest;
}

// Those that may come first: of the lowest priority, or of none.
std::vector<int> MayBegin(const std::vector<int>& units, const std::vector<UnitFacts>& facts) {
  const int lowest = LowestPriority(units, facts);
  std::vector<int> first;
  std::copy_if(units.begin(), units.end(), std::back_inserter(first), [&](int unit) {
    return facts[unit].priority == 0 || facts[unit].priority == lowest;
  });
  return first;
}

int PickBase(const std::vector<int>& units, const std::vector<UnitFacts>& facts) {
  const bool all_roll =
      std::all_of(units.begin(), units.end(), [&](int unit) { return facts[unit].rolls; });
  double lowest = std::numeric_limits<double>::max(), highest = -lowest;
  for (int unit : units) {
    if (facts[unit].rolls && !all_roll) continue;
    lowest = std::min(lowest, facts[unit].lowest);
    highest = std::max(highest, facts[unit].highest);
  }
  const double floor = lowest + 0.1 * (highest - lowest);
  int base = units.front();
  int64_t largest = -1;
  for (int unit : units) {
    if (facts[unit].rolls && !all_roll) continue;
    const int64_t volume = std::llround(facts[unit].volume * 1e9);
    if (facts[unit].lowest > floor + 1e-9 || volume <= largest) continue;
    largest = volume;
    base = unit;
  }
  return base;
}

class Disassembly {
 public:
  Disassembly(const std::vector<int>& units, const std::vector<UnitFacts>& facts, const Links& held,
              const Links& linked, const Blocking& blocking, const std::stop_token& stop,
              const ConnectionPriorities& priorities)
      : facts_(facts),
        links_({&held, &linked}),
        blocking_(blocking),
        stop_(stop),
        priorities_(priorities),
        left_(units) {
    std::sort(left_.begin(), left_.end());
    result_.base = PickBase(MayBegin(left_, facts), facts);
    follows_priorities_ = HighestPriority(left_, facts) > 0;
    hops_ = HopsFrom(result_.base, left_, InOnePiece(left_, held) ? held : linked);
    for (int direction = 0; direction < kDirections; ++direction) {
      blockers_[direction].assign(facts.size(), 0);
      for (int unit : left_) {
        for (int other : left_) {
          if (unit != other && blocking.Blocks(direction, unit, other)) {
            ++blockers_[direction][unit];
          }
        }
      }
    }
  }

  TakenApart Run() {
    while (left_.size() > 1) {
      if (!stop_.stop_requested() && (TakeOne() || TakeSeveral())) continue;
      if (!stop_.stop_requested() && follows_priorities_) {
        result_.conflict = FindConflict();
        if (result_.conflict) return std::move(result_);
        // What is stuck is so whatever the priorities.
        follows_priorities_ = false;
        continue;
      }
      result_.stuck = left_;
      return std::move(result_);
    }
    return std::move(result_);
  }

 private:
  // What is taken off first comes first.
  auto RankOf(int unit) const {
    const auto hops = hops_.find(unit);
    const UnitFacts& facts = facts_[unit];
    return std::make_tuple(!facts.built, -facts.group,
                           hops == hops_.end() ? std::numeric_limits<int>::min() : -hops->second,
                           -Millimetre(facts.highest), std::llround(facts.volume * 1e9), -unit);
  }

  void Remove(Removal removal) {
    left_ = Without(left_, removal.units);
    for (int direction = 0; direction < kDirections; ++direction) {
      for (int unit : left_) {
        for (int removed : removal.units) {
          if (blocking_.Blocks(direction, unit, removed)) --blockers_[direction][unit];
        }
      }
    }
    result_.steps.back().push_back(std::move(removal));
  }

  // The direction in which the unit can be taken off the others alone; nothing if there is none. Of
  // several the first on whose way back the unit comes to a stop, which is where it belongs.
  std::optional<int> WayOff(int unit) const {
    std::optional<int> way;
    for (int direction = 0; direction < kDirections; ++direction) {
      if (blockers_[direction][unit] > 0) continue;
      if (blockers_[Opposite(direction)][unit] > 0) return direction;
      if (!way) way = direction;
    }
    return way;
  }

  // The first of `free` without which the links join all that is left.
  std::vector<int>::iterator FirstToSpare(std::vector<int>& free, const Links& links) const {
    int pieces = 0;
    for (std::vector<int> rest = left_; !rest.empty() && pieces < 3; ++pieces) {
      std::vector<int> piece;
      for (const auto& [unit, hops] : HopsFrom(rest.front(), rest, links)) piece.push_back(unit);
      rest = Without(rest, piece);
    }
    if (pieces > 2) return free.end();
    if (pieces == 2) {
      // Only a piece that is a single unit can be spared.
      return std::find_if(free.begin(), free.end(), [&](int unit) {
        return HopsFrom(unit, left_, links).size() == 1 &&
               InOnePiece(Without(left_, {unit}), links);
      });
    }
    const std::vector<bool> cut = CutUnits(left_, links);
    return std::find_if(free.begin(), free.end(), [&](int unit) { return !cut[unit]; });
  }

  // Whether no unit that is left has a higher priority.
  bool MayLeave(int unit) const {
    return !follows_priorities_ || facts_[unit].priority == 0 ||
           facts_[unit].priority >= HighestPriority(left_, facts_);
  }

  // The priority with which several come off together: the highest of all that is left, which all
  // of them have, or that of all that fastens them to the rest. Nothing if they may not yet.
  std::optional<int> PriorityTogether(const std::vector<int>& leaving,
                                      const std::vector<int>& staying) const {
    if (!follows_priorities_) return 0;
    const int lowest = LowestPriority(leaving, facts_);
    if (lowest >= HighestPriority(left_, facts_)) return HighestPriority(leaving, facts_);
    if (priorities_.empty()) return std::nullopt;
    int broken = std::numeric_limits<int>::max(), highest = HighestPriority(staying, facts_);
    for (int unit : left_) {
      for (int other : left_) highest = std::max(highest, priorities_[unit][other]);
    }
    for (int unit : leaving) {
      for (int other : staying) {
        if (priorities_[unit][other] > 0) broken = std::min(broken, priorities_[unit][other]);
      }
    }
    if (broken == std::numeric_limits<int>::max() || broken < highest) return std::nullopt;
    return broken;
  }

  // By unit: whether what stays would not be joined without it.
  std::vector<bool> CutNow(const Links* kept) const {
    return kept == nullptr ? std::vector<bool>(facts_.size(), false) : CutUnits(left_, *kept);
  }

  // Takes off those of a family that come off alone, as far as `kept` joins what stays.
  void TakeFamily(const std::string& family, const Links* kept) {
    std::vector<bool> cut = CutNow(kept);
    for (int unit : std::vector<int>(left_)) {
      if (unit == result_.base || facts_[unit].family != family || cut[unit]) continue;
      const std::optional<int> way = WayOff(unit);
      if (!way || !MayLeave(unit)) continue;
      Remove({{unit}, *way, facts_[unit].priority});
      cut = CutNow(kept);
    }
  }

  // Takes off those of a priority among `free`, as far as `kept` joins what stays. Each of them
  // came off while all others stood, so they come in in any order.
  void TakePriority(int priority, const std::vector<Removal>& free, const Links* kept) {
    std::vector<bool> cut = CutNow(kept);
    for (const Removal& removal : free) {
      const int unit = removal.units.front();
      if (facts_[unit].priority != priority || cut[unit]) continue;
      if (!std::binary_search(left_.begin(), left_.end(), unit)) continue;
      Remove(removal);
      cut = CutNow(kept);
    }
  }

  // Takes off the unit that ranks first, and with it the others of its family.
  bool TakeOne() {
    std::vector<int> free;
    for (int unit : left_) {
      if (unit != result_.base && WayOff(unit) && MayLeave(unit)) free.push_back(unit);
    }
    if (free.empty()) return false;
    std::sort(free.begin(), free.end(), [&](int a, int b) { return RankOf(a) < RankOf(b); });
    auto chosen = free.begin();
    const Links* kept = nullptr;  // the links that join what stays
    for (const Links* links : links_) {
      if (kept != nullptr) break;
      const auto found = FirstToSpare(free, *links);
      if (found == free.end()) continue;
      chosen = found;
      kept = links;
    }
    const int first = *chosen;
    std::vector<Removal> ways;
    for (int unit : free) ways.push_back({{unit}, *WayOff(unit), facts_[unit].priority});
    result_.steps.emplace_back();
    Remove({{first}, *WayOff(first), facts_[first].priority});
    if (follows_priorities_ && facts_[first].priority > 0) {
      TakePriority(facts_[first].priority, ways, kept);
    }
    if (!facts_[first].family.empty()) TakeFamily(facts_[first].family, kept);
    return true;
  }

  // Takes off the fewest units that come off together.
  bool TakeSeveral() {
    using Rank = std::tuple<bool, std::size_t, int, std::vector<int>, int>;
    std::optional<Rank> best;
    for (int direction = 0; direction < kDirections; ++direction) {
      for (int unit : left_) {
        if (stop_.stop_requested()) return false;
        std::vector<int> moving = blocking_.MovesWith(direction, unit, left_);
        if (moving.size() == left_.size()) continue;
        std::vector<int> staying = Without(left_, moving);
        int way = direction;
        if (std::binary_search(moving.begin(), moving.end(), result_.base)) {
          std::swap(moving, staying);
          way = Opposite(direction);
        }
        const std::optional<int> priority = PriorityTogether(moving, staying);
        if (!priority) continue;
        const bool loose = !InOnePiece(moving, *links_[1]) || !InOnePiece(staying, *links_[1]);
        const std::size_t count = moving.size();
        Rank rank(loose, count, way, std::move(moving), *priority);
        if (!best || rank < *best) best = std::move(rank);
      }
    }
    if (!best) return false;
    result_.steps.emplace_back();
    Remove({std::get<3>(*best), std::get<2>(*best), std::get<4>(*best)});
    return true;
  }

  // Of the units of the highest priority, the first that would come off but for one of a lower one.
  std::optional<PriorityConflict> FindConflict() const {
    const int highest = HighestPriority(left_, facts_);
    std::optional<PriorityConflict> found;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (int late : left_) {
      if (facts_[late].priority != highest) continue;
      for (int direction = 0; direction < kDirections; ++direction) {
        std::vector<int> leaving = blocking_.MovesWith(direction, late, left_);
        if (leaving.size() == left_.size()) continue;
        if (std::binary_search(leaving.begin(), leaving.end(), result_.base)) {
          leaving = Without(left_, leaving);
        }
        std::vector<int> lower;
        for (int unit : leaving) {
          const int priority = facts_[unit].priority;
          if (unit != late && priority > 0 && priority < highest) lower.push_back(unit);
        }
        if (lower.empty() || leaving.size() >= fewest) continue;
        fewest = leaving.size();
        const auto beside = std::find_if(lower.begin(), lower.end(), [&](int unit) {
          return blocking_.Blocks(direction, late, unit);
        });
        found = PriorityConflict{late, beside == lower.end() ? lower.front() : *beside};
      }
    }
    return found;
  }

  const std::vector<UnitFacts>& facts_;
  const std::array<const Links*, 2> links_;  // the better first
  const Blocking& blocking_;
  const std::stop_token stop_;
  const ConnectionPriorities& priorities_;
  std::vector<int> left_;
  std::array<std::vector<int>, kDirections> blockers_;  // of each unit, among those left
  std::map<int, int> hops_;
  bool follows_priorities_ = false;  // no unit has one, or they do not matter any more
  TakenApart result_;
};

}  // namespace

bool InOnePiece(const std::vector<int>& units, const Links& links) {
  return units.empty() || HopsFrom(units.front(), units, links).size() == units.size();
}

TakenApart TakeApart(const std::vector<int>& units, const std::vector<UnitFacts>& facts,
                     const Links& held, const Links& linked, const Blocking& blocking,
                     const std::stop_token& stop, const ConnectionPriorities& priorities) {
  return Disassembly(units, facts, held, linked, blocking, stop, priorities).Run();
}

}  // namespace mortise::fabplanner
