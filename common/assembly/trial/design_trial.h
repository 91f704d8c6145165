// Tries a parametrised design before anybody uses it: what linear relationships along the axes do
// not say, some design among corners of the feasible set and points between them shows.
//
// A grid of resizable parts may stretch beyond the board it stands on, as how many parts it has and
// how large they are is not linear in its box; a lid at 100° has no planes along the axes that
// could keep it clear of what it leans over; nor has a leg that is let into a seat aslant.
#pragma once

#include <functional>
#include <set>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/relations/feasible_set.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// What makes the designs that were tried sound, parts by their index in the assembly.
struct RepairPlan {
  std::set<int> lone;  // better in no pattern: PatternExclusions::lone
  KnownConflicts known_conflicts;
};

// Where two elements run into each other in a pose, and their boxes are apart as drawn, they are to
// be kept apart; where they come apart in one, and their boxes touch as drawn, to be kept touching;
// where the boxes of two that are no patterns meet in a pose as drawn, and one of them has a shape,
// they are to stretch together; any other fault gives up the patterns of its elements, of fasteners
// before those of what they fasten. Parts count as their boxes but for shapes that may move or
// stretch against what they touch. Nothing of `known` is said again, nor of designs without
// patterns, rest poses and such shapes. The same designs are tried whenever the same is asked.
// Fails as FeasibleSet::Corners and ContactCheck::FaultsAt; CANCELLED if `is_given_up`, which is
// asked before each design.
absl::StatusOr<RepairPlan> TryDesigns(const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const FeasibleSet& feasible_set, const RepairPlan& known,
                                      double tolerance, const std::function<bool()>& is_given_up);

}  // namespace mortise::parametric
