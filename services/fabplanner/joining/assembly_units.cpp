#include "services/fabplanner/joining/assembly_units.h"

#include <algorithm>

namespace mortise::fabplanner {
namespace {

void Link(int a, int b, Links* links) {
  if (a >= 0 && b >= 0) (*links)[a][b] = (*links)[b][a] = true;
}

}  // namespace

std::vector<int> UnitOfParts(const Design& design, const std::vector<AssemblyUnit>& units) {
  std::vector<int> unit_of(design.parts.size(), -1);
  for (std::size_t unit = 0; unit < units.size(); ++unit) {
    for (int part : units[unit].parts) unit_of[part] = static_cast<int>(unit);
  }
  return unit_of;
}

std::vector<UnitFacts> FactsOf(const Design& design, const Items& items,
                               const std::vector<PartSolid>& solids,
                               const std::vector<AssemblyUnit>& units) {
  std::vector<UnitFacts> facts;
  for (const AssemblyUnit& unit : units) {
    Eigen::AlignedBox3d box;
    for (int part : unit.parts) box.extend(solids[part].box());
    const Part& first = design.parts[unit.parts.front()];
    const auto item = items.find(first.item);
    const bool rolls = unit.built.empty() && item != items.end() && item->second.round &&
                       item->second.kind == ItemKind::kHardware;
    facts.push_back({unit.built.empty() ? first.family : "", !unit.built.empty(), rolls,
                     unit.built.empty() ? first.group : 0, box.min().z(), box.max().z(),
                     box.volume()});
  }
  return facts;
}

Links HeldLinks(const Design& design, const Joints& joints,
                const std::vector<AssemblyUnit>& units) {
  const std::vector<int> unit_of = UnitOfParts(design, units);
  Links held(units.size(), std::vector<bool>(units.size(), false));
  for (const Fixing& fixing : joints.fixings) {
    const bool within = std::all_of(fixing.principals.begin(), fixing.principals.end(),
                                    [&](int part) { return unit_of[part] >= 0; });
    if (!within) continue;
    for (int part : fixing.principals) {
      Link(unit_of[fixing.principals.front()], unit_of[part], &held);
    }
  }
  return held;
}

Links AllLinks(const Design& design, const Joints& joints, const std::vector<AssemblyUnit>& units) {
  const std::vector<int> unit_of = UnitOfParts(design, units);
  Links links = HeldLinks(design, joints, units);
  const int count = static_cast<int>(design.parts.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (joints.touching[a][b]) Link(unit_of[a], unit_of[b], &links);
    }
  }
  return links;
}

}  // namespace mortise::fabplanner
