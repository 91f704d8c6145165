#include "services/fabplanner/joining/fixings.h"

#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace mortise::fabplanner {
namespace {

int Root(std::vector<int>& parent, int part) {
  while (parent[part] != part) part = parent[part] = parent[parent[part]];
  return part;
}

bool IsPin(const Part& part, const Items& items) {
  const auto item = items.find(part.item);
  return item != items.end() &&
         (item->second.kind == ItemKind::kScrew || item->second.kind == ItemKind::kBolt ||
          item->second.kind == ItemKind::kDowel);
}

// What a screw holds it reaches into: a part that lies against its head is not held by it.
void KeepWhatIsEntered(const std::vector<PartSolid>& solids, int pin, std::set<int>* reached) {
  std::set<int> entered;
  for (int part : *reached) {
    if (solids[pin].Overlaps(solids[part])) entered.insert(part);
  }
  if (!entered.empty()) *reached = std::move(entered);
}

// The parts that a peg reaches into, pairwise.
void AddTies(const std::vector<int>& reached, int axis, std::vector<PegTie>* pegs) {
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (std::size_t j = i + 1; j < reached.size(); ++j) {
      pegs->push_back({reached[i], reached[j], axis});
    }
  }
}

}  // namespace

Joints FindJoints(const Design& design, const Items& items, const std::vector<PartSolid>& solids,
                  const std::stop_token& stop) {
  const int count = static_cast<int>(design.parts.size());
  Joints joints;
  joints.touching.assign(count, std::vector<bool>(count, false));
  std::vector<int> parent(count);
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<std::set<int>> reached(count);  // principals that a connector touches
  for (int i = 0; i < count && !stop.stop_requested(); ++i) {
    for (int j = i + 1; j < count; ++j) {
      if (!solids[i].Touches(solids[j])) continue;
      const bool first = design.parts[i].connecting, second = design.parts[j].connecting;
      if (first && second) {
        parent[Root(parent, i)] = Root(parent, j);
      } else if (first) {
        reached[i].insert(j);
      } else if (second) {
        reached[j].insert(i);
      } else {
        joints.touching[i][j] = joints.touching[j][i] = true;
      }
    }
  }
  std::map<int, std::size_t> fixing_of;
  std::vector<std::set<int>> principals;
  for (int i = 0; i < count; ++i) {
    if (!design.parts[i].connecting) continue;
    const auto [entry, is_new] = fixing_of.emplace(Root(parent, i), joints.fixings.size());
    if (is_new) {
      joints.fixings.emplace_back();
      principals.emplace_back();
    }
    joints.fixings[entry->second].connectors.push_back(i);
    if (IsPin(design.parts[i], items)) KeepWhatIsEntered(solids, i, &reached[i]);
    principals[entry->second].insert(reached[i].begin(), reached[i].end());
    const auto item = items.find(design.parts[i].item);
    if (item == items.end() || item->second.kind != ItemKind::kDowel) continue;
    std::vector<int> around;
    for (int part : reached[i]) {
      if (solids[i].Overlaps(solids[part])) around.push_back(part);
    }
    AddTies(around, design.parts[i].length_axis, &joints.pegs);
  }
  for (std::size_t i = 0; i < principals.size(); ++i) {
    joints.fixings[i].principals.assign(principals[i].begin(), principals[i].end());
  }
  return joints;
}

}  // namespace mortise::fabplanner
