// Finds what holds parts together: connecting parts that touch each other, with the parts they
// touch (thesis §3.6).
#pragma once

#include <stop_token>
#include <vector>

#include "services/fabplanner/joining/part_solid.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// Connecting parts that belong together: a hinge with its screws, a bolt with washers and nut. All
// are indices of parts, ascending.
struct Fixing {
  std::vector<int> connectors;
  std::vector<int> principals;  // that they touch; empty for what touches nothing
};

// A peg that parts are pushed onto along its length.
struct PegTie {
  int part = 0;
  int other_part = 0;
  int axis = 0;
};

struct Joints {
  std::vector<Fixing> fixings;              // by their first connector
  std::vector<std::vector<bool>> touching;  // of principal parts, directly
  std::vector<PegTie> pegs;
};

// `solids` are those of the parts, in order. O(parts²). Once a stop is requested, what is not
// compared yet does not touch.
Joints FindJoints(const Design& design, const Items& items, const std::vector<PartSolid>& solids,
                  const std::stop_token& stop = {});

}  // namespace mortise::fabplanner
