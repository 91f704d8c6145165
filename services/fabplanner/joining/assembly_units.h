// What moves as one while a group is put together, and what is known of it from its parts.
#pragma once

#include <string>
#include <vector>

#include "services/fabplanner/joining/fixings.h"
#include "services/fabplanner/joining/part_solid.h"
#include "services/fabplanner/joining/taking_apart.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// A part, or a sub-assembly that is built already.
struct AssemblyUnit {
  std::vector<int> parts;  // by index, at least one; with the connectors that hold it together
  std::string built;       // the sub-assembly's name; empty for a part
};

// Returns the index of the unit that each part of the design is of; -1 for none.
std::vector<int> UnitOfParts(const Design& design, const std::vector<AssemblyUnit>& units);

// Returns what taking apart needs to know of each unit, but for priorities. `solids` are those of
// the design's parts.
std::vector<UnitFacts> FactsOf(const Design& design, const Items& items,
                               const std::vector<PartSolid>& solids,
                               const std::vector<AssemblyUnit>& units);

// Returns which units are held to each other by connectors that hold nothing else.
Links HeldLinks(const Design& design, const Joints& joints, const std::vector<AssemblyUnit>& units);

// Returns which are, or touch.
Links AllLinks(const Design& design, const Joints& joints, const std::vector<AssemblyUnit>& units);

}  // namespace mortise::fabplanner
