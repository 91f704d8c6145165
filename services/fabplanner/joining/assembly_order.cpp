#include "services/fabplanner/joining/assembly_order.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/joining/assembly_priorities.h"
#include "services/fabplanner/joining/assembly_units.h"
#include "services/fabplanner/joining/step_text.h"
#include "services/fabplanner/joining/taking_apart.h"

namespace mortise::fabplanner {
namespace {

// The priority of what comes in later where nothing that has one does.
constexpr int kNothingMore = std::numeric_limits<int>::max();

std::vector<PartSolid> SolidsOf(const Design& design) {
  std::vector<PartSolid> solids;
  solids.reserve(design.parts.size());
  for (const Part& part : design.parts) solids.emplace_back(part);
  return solids;
}

class Builder {
 public:
  Builder(const Design& design, const Items& items, const std::vector<Mark>& marks,
          const std::stop_token& stop)
      : design_(design),
        items_(items),
        marks_(marks),
        stop_(stop),
        solids_(SolidsOf(design)),
        joints_(FindJoints(design, items, solids_, stop)),
        priorities_(design, joints_),
        is_fixed_(joints_.fixings.size(), false),
        is_added_(design.parts.size(), 0) {}

  absl::StatusOr<std::vector<AssemblyStep>> Build() {
    contradiction_ = priorities_.Check();
    const AssemblyUnit whole = BuildGroup(0);
    MORTISE_RETURN_IF_ERROR(contradiction_);
    AddLooseConnectors(whole.parts);
    return std::move(steps_);
  }

 private:
  // The group as one unit; its parts are empty if it has no principal ones, or priorities
  // contradict each other.
  AssemblyUnit BuildGroup(int group) {
    if (!contradiction_.ok()) return {};
    std::vector<AssemblyUnit> units;
    for (const Piece& piece : PiecesOf(group)) {
      if (piece.group < 0) {
        units.push_back({{piece.part}, ""});
        continue;
      }
      AssemblyUnit built = BuildGroup(piece.group);
      if (!built.parts.empty()) units.push_back(std::move(built));
    }
    if (units.empty() || !contradiction_.ok()) return {};
    AssemblyUnit built = PutTogether(units, design_.groups[group].name);
    built.built = units.size() == 1 && units.front().parts.size() == built.parts.size()
                      ? units.front().built
                      : design_.groups[group].name;
    return built;
  }

  // What a group is put together of: a sub-assembly, or a principal part.
  struct Piece {
    int group = -1;
    int part = -1;
  };

  std::vector<Piece> DirectPiecesOf(int group) const {
    std::vector<Piece> pieces;
    for (std::size_t child = 1; child < design_.groups.size(); ++child) {
      if (design_.groups[child].parent == group) pieces.push_back({static_cast<int>(child), -1});
    }
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      const Part& part = design_.parts[i];
      if (part.group == group && !part.connecting) pieces.push_back({-1, static_cast<int>(i)});
    }
    return pieces;
  }

  std::vector<int> PrincipalsOf(const Piece& piece) const {
    if (piece.group < 0) return {piece.part};
    std::vector<int> parts;
    for (const Piece& direct : DirectPiecesOf(piece.group)) {
      const std::vector<int> within = PrincipalsOf(direct);
      parts.insert(parts.end(), within.begin(), within.end());
    }
    return parts;
  }

  // The pieces of a group. Sub-assemblies that do not hold together, or cannot be brought to the
  // others in one piece, are not built by themselves: their own pieces are the group's.
  std::vector<Piece> PiecesOf(int group) const {
    std::vector<Piece> pieces = DirectPiecesOf(group);
    for (std::size_t i = 0; i < pieces.size();) {
      if (pieces[i].group < 0 || HoldsTogether(pieces[i].group)) {
        ++i;
        continue;
      }
      const std::vector<Piece> own = DirectPiecesOf(pieces[i].group);
      pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(i));
      pieces.insert(pieces.begin() + static_cast<std::ptrdiff_t>(i), own.begin(), own.end());
    }
    while (true) {
      std::vector<AssemblyUnit> units;
      std::vector<std::size_t> piece_of;
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        AssemblyUnit unit{PrincipalsOf(pieces[i]), pieces[i].group < 0 ? "" : "built"};
        if (unit.parts.empty()) continue;
        units.push_back(std::move(unit));
        piece_of.push_back(i);
      }
      if (units.size() < 2) return pieces;
      std::vector<int> all;
      std::vector<std::vector<int>> parts_of;
      for (std::size_t i = 0; i < units.size(); ++i) {
        all.push_back(static_cast<int>(i));
        parts_of.push_back(units[i].parts);
      }
      const Blocking blocking(design_, items_, solids_, joints_, parts_of, stop_);
      const TakenApart apart = TakeApart(all, FactsWith(units), HeldOf(units), LinksOf(units),
                                         blocking, stop_, priorities_.BetweenUnits(units));
      std::set<std::size_t> dissolved;
      for (int unit : apart.stuck) {
        if (pieces[piece_of[unit]].group >= 0) dissolved.insert(piece_of[unit]);
      }
      if (dissolved.empty()) return pieces;
      std::vector<Piece> finer;
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (!dissolved.contains(i)) {
          finer.push_back(pieces[i]);
          continue;
        }
        const std::vector<Piece> own = DirectPiecesOf(pieces[i].group);
        finer.insert(finer.end(), own.begin(), own.end());
      }
      pieces = std::move(finer);
    }
  }

  // Puts all units of a group together, from a copy of those it is called with.
  AssemblyUnit PutTogether(const std::vector<AssemblyUnit>& units, const std::string& name) {
    if (units.size() == 1) {
      if (!ReadyFixings(units.front().parts).empty() || (name.empty() && steps_.empty())) {
        StepFacts facts;
        facts.arrivals.push_back({units.front().parts, units.front().built, ""});
        return {AddSteps(std::move(facts), {}, name, {Eigen::Vector3d::Zero()}, kNothingMore), ""};
      }
      return units.front();
    }
    std::vector<std::vector<int>> parts_of;
    for (const AssemblyUnit& unit : units) parts_of.push_back(unit.parts);
    CheckBuilt(units);
    const Blocking blocking(design_, items_, solids_, joints_, parts_of, stop_);
    std::vector<int> all;
    for (std::size_t i = 0; i < units.size(); ++i) all.push_back(static_cast<int>(i));
    int pieces = 0;
    return {Join(units, all, FactsWith(units), blocking, name, &pieces), ""};
  }

  std::vector<int> Join(const std::vector<AssemblyUnit>& units, const std::vector<int>& chosen,
                        const std::vector<UnitFacts>& unit_facts, const Blocking& blocking,
                        const std::string& name, int* pieces) {
    if (chosen.size() == 1) return units[chosen.front()].parts;
    const TakenApart apart = TakeApart(chosen, unit_facts, HeldOf(units), LinksOf(units), blocking,
                                       stop_, priorities_.BetweenUnits(units));
    if (apart.conflict) SetConflict(units, *apart.conflict);
    if (!contradiction_.ok()) return {};
    const std::vector<int> coming = ComingAfter(apart);
    std::vector<int> standing;
    StepFacts facts;
    std::vector<Eigen::Vector3d> ways_in;
    const auto begin = [&](int unit) {
      facts.arrivals.push_back({units[unit].parts, units[unit].built, ""});
      ways_in.emplace_back(Eigen::Vector3d::Zero());
    };
    begin(apart.base);
    if (!apart.stuck.empty()) {
      for (int unit : apart.stuck) {
        if (unit != apart.base) begin(unit);
        for (int part : units[unit].parts) {
          if (!design_.parts[part].connecting) facts.stuck.push_back(part);
        }
      }
      standing = AddSteps(std::exchange(facts, {}), standing, name, std::exchange(ways_in, {}),
                          coming[apart.steps.size()]);
    }
    for (auto step = apart.steps.rbegin(); step != apart.steps.rend(); ++step) {
      for (auto removal = step->rbegin(); removal != step->rend(); ++removal) {
        StepFacts::Arrival arrival{units[removal->units.front()].parts,
                                   units[removal->units.front()].built,
                                   ComingFrom(removal->direction)};
        if (removal->units.size() > 1) {
          arrival.built =
              absl::StrCat("piece ", ++*pieces, " of the ", name.empty() ? "whole" : name);
          arrival.parts = Join(units, removal->units, unit_facts, blocking, arrival.built, pieces);
          if (!contradiction_.ok()) return {};
        }
        facts.arrivals.push_back(std::move(arrival));
        ways_in.emplace_back(-DirectionOf(removal->direction));
      }
      for (const auto& [a, b] : blocking.unknown()) {
        if (MeetIn(facts, standing, a, b)) facts.unknown.emplace_back(a, b);
      }
      const auto later = static_cast<std::size_t>(std::distance(step, apart.steps.rend())) - 1;
      standing = AddSteps(std::exchange(facts, {}), standing, name, std::exchange(ways_in, {}),
                          coming[later]);
    }
    return standing;
  }

  // The lowest priority of the first so many steps of taking apart, which come in last.
  static std::vector<int> ComingAfter(const TakenApart& apart) {
    std::vector<int> lowest = {kNothingMore};
    for (const std::vector<Removal>& step : apart.steps) {
      lowest.push_back(lowest.back());
      for (const Removal& removal : step) {
        if (removal.priority > 0) lowest.back() = std::min(lowest.back(), removal.priority);
      }
    }
    return lowest;
  }

  // Finds sub-assemblies that are built before what is to be done first.
  void CheckBuilt(const std::vector<AssemblyUnit>& units) {
    if (!priorities_.any()) return;
    const std::vector<PriorityTag> tags = priorities_.OfUnits(units);
    for (std::size_t i = 0; i < units.size() && contradiction_.ok(); ++i) {
      if (units[i].built.empty()) continue;
      contradiction_ = priorities_.CheckBuilt(units[i].parts, units[i].built, tags[i]);
    }
  }

  void SetConflict(const std::vector<AssemblyUnit>& units, const PriorityConflict& conflict) {
    const std::vector<PriorityTag> tags = priorities_.OfUnits(units);
    contradiction_ = priorities_.Conflict(tags[conflict.late], units[conflict.late].parts,
                                          tags[conflict.early], units[conflict.early].parts);
  }

  // Whether a step is the first in which both parts are there.
  static bool MeetIn(const StepFacts& facts, const std::vector<int>& standing, int a, int b) {
    const auto has = [](const std::vector<int>& parts, int part) {
      return std::find(parts.begin(), parts.end(), part) != parts.end();
    };
    const auto arrival_of = [&](int part) {
      for (std::size_t i = 0; i < facts.arrivals.size(); ++i) {
        if (has(facts.arrivals[i].parts, part)) return static_cast<int>(i);
      }
      return has(standing, part) ? -1 : -2;
    };
    const int of_a = arrival_of(a), of_b = arrival_of(b);
    return of_a > -2 && of_b > -2 && of_a != of_b;
  }

  // Adds the step that brings parts in, and those that only make connections of later priorities;
  // all that stands after them. `coming` is the lowest priority of what comes in later: connections
  // of later ones wait for it.
  std::vector<int> AddSteps(StepFacts facts, std::vector<int> standing, const std::string& name,
                            const std::vector<Eigen::Vector3d>& ways_in, int coming) {
    std::vector<int> present = standing;
    for (const StepFacts::Arrival& arrival : facts.arrivals) {
      present.insert(present.end(), arrival.parts.begin(), arrival.parts.end());
    }
    std::vector<int> now;
    std::map<int, std::vector<int>> later;  // by priority
    for (int fixing : ReadyFixings(present)) {
      const int priority = priorities_.OfFixing(fixing).priority;
      if (priority > coming && HasPegs(joints_.fixings[fixing])) {
        contradiction_ = priorities_.PegConflict(fixing, coming);
        return {};
      }
      if (priority == 0 || HasPegs(joints_.fixings[fixing])) {
        now.push_back(fixing);
      } else if (priority <= coming) {
        later[priority].push_back(fixing);
      }
    }
    if (!later.empty()) {
      const auto first = later.begin();
      now.insert(now.end(), first->second.begin(), first->second.end());
      std::sort(now.begin(), now.end());
      later.erase(first);
    }
    standing = AddStep(std::move(facts), std::move(standing), name, ways_in, now);
    for (const auto& [priority, fixings] : later) {
      // Those of the next step's priority are made with it.
      if (priority < coming) standing = AddStep({}, std::move(standing), name, {}, fixings);
    }
    return standing;
  }

  bool HasPegs(const Fixing& fixing) const {
    return std::any_of(fixing.connectors.begin(), fixing.connectors.end(), [&](int connector) {
      const auto item = items_.find(design_.parts[connector].item);
      return item != items_.end() && item->second.kind == ItemKind::kDowel;
    });
  }

  // The latest of the priorities with which parts come in and connections are made.
  int PriorityOf(const StepFacts& facts, const std::vector<int>& fixings) const {
    int latest = 0;
    for (int fixing : fixings) latest = std::max(latest, priorities_.OfFixing(fixing).priority);
    for (const StepFacts::Arrival& arrival : facts.arrivals) {
      if (!arrival.built.empty() || is_added_[arrival.parts.front()]) continue;
      latest = std::max(latest, design_.parts[arrival.parts.front()].priority);
    }
    return latest;
  }

  // Adds the step with these connections; all that stands after it. Without arrivals what stands
  // is what they are made in.
  std::vector<int> AddStep(StepFacts facts, std::vector<int> standing, const std::string& name,
                           const std::vector<Eigen::Vector3d>& ways_in,
                           const std::vector<int>& fixings) {
    AssemblyStep step;
    step.number = static_cast<int>(steps_.size()) + 1;
    step.priority = priorities_.any() ? PriorityOf(facts, fixings) : step.number;
    step.subassembly = name;
    std::vector<std::string> before;
    for (int part : standing) before.push_back(design_.parts[part].name);
    if (facts.arrivals.empty()) {
      step.moves.push_back({std::move(before), Eigen::Vector3d::Zero()});
    } else {
      step.standing = std::move(before);
    }
    for (std::size_t i = 0; i < facts.arrivals.size(); ++i) {
      AssemblyStep::Move& move = step.moves.emplace_back();
      move.way_in = ways_in[i];
      for (int part : facts.arrivals[i].parts) {
        move.parts.push_back(design_.parts[part].name);
        standing.push_back(part);
        if (!std::exchange(is_added_[part], 1)) {
          step.added_parts.push_back(design_.parts[part].name);
        }
      }
    }
    for (int fixing : fixings) {
      AddFixing(joints_.fixings[fixing], &step);
      is_fixed_[fixing] = true;
      for (int connector : joints_.fixings[fixing].connectors) {
        facts.connectors.push_back(connector);
        standing.push_back(connector);
        is_added_[connector] = 1;
      }
    }
    facts.subassembly = name;
    for (const Mark& mark : marks_) {
      for (const std::string& connector : step.connectors) {
        if (mark.connector == connector) facts.marks.push_back(mark);
      }
    }
    step.instruction = StepText(design_, items_, facts);
    steps_.push_back(std::move(step));
    return standing;
  }

  // The fixings that hold nothing but these parts, and are not there yet.
  std::vector<int> ReadyFixings(const std::vector<int>& parts) const {
    const std::set<int> present(parts.begin(), parts.end());
    std::vector<int> ready;
    for (std::size_t i = 0; i < joints_.fixings.size(); ++i) {
      const std::vector<int>& held = joints_.fixings[i].principals;
      if (is_fixed_[i] || held.empty()) continue;
      if (std::all_of(held.begin(), held.end(), [&](int part) { return present.contains(part); })) {
        ready.push_back(static_cast<int>(i));
      }
    }
    return ready;
  }

  // Its connectors, counted by the parts that are held and by item.
  void AddFixing(const Fixing& fixing, AssemblyStep* step) const {
    std::vector<std::string> titles;
    for (int part : fixing.principals) titles.push_back(TitleOf(design_.parts[part]));
    const std::string name = titles.empty() ? "" : CountedTitles(design_, fixing.principals);
    for (int connector : fixing.connectors) {
      const Part& part = design_.parts[connector];
      step->connectors.push_back(part.name);
      const auto item = items_.find(part.item);
      if (item != items_.end() && item->second.kind == ItemKind::kDowel) ++step->pegs;
      const auto same = std::find_if(step->connections.begin(), step->connections.end(),
                                     [&](const StepConnection& other) {
                                       return other.name == name && other.item == part.item;
                                     });
      if (same != step->connections.end()) {
        ++same->pegs;
        continue;
      }
      StepConnection& connection = step->connections.emplace_back();
      connection.name = name;
      connection.item = part.item;
      connection.pegs = 1;
      if (fixing.principals.empty()) continue;
      connection.part = design_.parts[fixing.principals.front()].name;
      connection.other_part = design_.parts[fixing.principals.back()].name;
    }
  }

  // What touches nothing still has to come in.
  void AddLooseConnectors(const std::vector<int>& standing) {
    StepFacts facts;
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      if (!is_added_[i]) facts.arrivals.push_back({{static_cast<int>(i)}, "", ""});
    }
    if (facts.arrivals.empty()) return;
    const std::vector<Eigen::Vector3d> ways(facts.arrivals.size(), Eigen::Vector3d::Zero());
    AddStep(std::move(facts), standing, "", ways, {});
  }

  // With their priorities.
  std::vector<UnitFacts> FactsWith(const std::vector<AssemblyUnit>& units) const {
    std::vector<UnitFacts> facts = FactsOf(design_, items_, solids_, units);
    const std::vector<PriorityTag> tags = priorities_.OfUnits(units);
    for (std::size_t i = 0; i < units.size(); ++i) facts[i].priority = tags[i].priority;
    return facts;
  }

  Links HeldOf(const std::vector<AssemblyUnit>& units) const {
    return HeldLinks(design_, joints_, units);
  }

  Links LinksOf(const std::vector<AssemblyUnit>& units) const {
    return AllLinks(design_, joints_, units);
  }

  // Whether the pieces of a group hold together by themselves: only then it is built by itself.
  bool HoldsTogether(int group) const {
    std::vector<AssemblyUnit> units;
    std::vector<int> all;
    for (const Piece& piece : DirectPiecesOf(group)) {
      AssemblyUnit unit{PrincipalsOf(piece), ""};
      if (unit.parts.empty()) continue;
      all.push_back(static_cast<int>(units.size()));
      units.push_back(std::move(unit));
    }
    return InOnePiece(all, joints_.fixings.empty() ? LinksOf(units) : HeldOf(units));
  }

  const Design& design_;
  const Items& items_;
  const std::vector<Mark>& marks_;
  const std::stop_token stop_;
  const std::vector<PartSolid> solids_;
  const Joints joints_;
  const AssemblyPriorities priorities_;
  absl::Status contradiction_;  // of priorities, the first that was found
  std::vector<bool> is_fixed_;  // fixings
  std::vector<char> is_added_;  // parts
  std::vector<AssemblyStep> steps_;
};

}  // namespace

bool HasOrderOfItsOwn(const Design& design) {
  if (!design.pegs.empty()) return false;
  return design.is_drawn || design.groups.size() > 1 ||
         std::any_of(design.parts.begin(), design.parts.end(), [](const Part& part) {
           return part.connecting || IsShaped(part) || part.item.empty();
         });
}

absl::StatusOr<std::vector<AssemblyStep>> OrderedSteps(const Design& design, const Items& items,
                                                       const std::vector<Mark>& marks,
                                                       const std::stop_token& stop) {
  return Builder(design, items, marks, stop).Build();
}

}  // namespace mortise::fabplanner
