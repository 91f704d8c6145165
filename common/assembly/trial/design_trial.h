// Tries a parametrised design before anybody uses it. What linear relationships along the axes do
// not say, some design among corners of the feasible set and points between them shows. The trial
// and its remedies are our own.
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

// The changes that make the designs that were tried sound, with parts by their index in the
// assembly.
struct RepairPlan {
  std::set<int> lone;  // better in no pattern: PatternExclusions::lone
  KnownConflicts known_conflicts;
};

// Tries designs of the feasible set, and returns what mends their faults:
// - Two elements that run into each other in a pose, and whose boxes are apart as drawn, are to be
//   kept apart.
// - Two that come apart in a pose, and whose boxes touch as drawn, are to be kept touching.
// - Two that are no patterns, whose boxes meet in a pose as drawn, and of which one has a shape,
//   are to stretch together.
// - Any other fault gives up the patterns of its elements, those of fasteners before those of what
//   they fasten.
//
// Parts count as their boxes but for shapes that may move or stretch against what they touch.
// Nothing of `known` is returned again, and nothing for designs without patterns, rest poses and
// such shapes. The same designs are tried whenever the same is asked. Fails as FeasibleSet::Corners
// and ContactCheck::FaultsAt do; CANCELLED if `is_given_up`, which is asked before each two
// designs. `tried` is told how many designs have been tried, and of how many. Two are tried at a
// time, each by a thread of its own; what they show is taken in their order, so that threads change
// nothing.
absl::StatusOr<RepairPlan> TryDesigns(
    const Assembly& assembly, const std::vector<Element>& elements, const FeasibleSet& feasible_set,
    const RepairPlan& known, double tolerance, const std::function<bool()>& is_given_up,
    const std::function<void(std::size_t done, std::size_t total)>& tried = [](std::size_t,
                                                                               std::size_t) {});

}  // namespace mortise::parametric
