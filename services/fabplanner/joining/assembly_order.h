// Finds the order in which a design is put together whose connectors are parts: screws, hinges,
// slides.
//
// Sub-assemblies first (a drawer, then the cabinet), each by itself, unless they only come together
// as single parts. What stands lowest and is largest comes first; then each step adds parts that
// touch what is there, or are held to it, and that come in by a straight movement along an axis:
// taking_apart.h. Connecting parts come in with the step that brings the last of the parts that
// they hold. Pegs are part of the way in: what is pushed onto pegs comes along them.
//
// Where the expert gives priorities (assembly_priorities.h), what has a lower one comes in, and is
// made, first; connections of one priority are one step where they can. What has none comes in
// where its shape lets it.
//
// Judged are the ways of principal parts, by part_solid.h. Not judged: whether a screw can be
// reached, the ways of connecting parts, and movements that turn.
#pragma once

#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Whether the steps of a design follow from its shapes; otherwise from its pegs
// (assembly_sequence.h).
bool HasOrderOfItsOwn(const Design& design);

// Returns the steps, numbered 1, 2, 3 …; every part, connecting ones included, comes in with
// exactly one of them. Where no order exists the step that brings parts together names those that
// block each other. Depends on nothing but its arguments. Once a stop is requested it returns soon,
// with steps that are of no use. O(parts³).
//
// FAILED_PRECONDITION, reason PRIORITIES_CONTRADICT, where priorities contradict each other or the
// shapes, naming the two parts or connections.
absl::StatusOr<std::vector<AssemblyStep>> OrderedSteps(const Design& design, const Items& items,
                                                       const std::vector<Mark>& marks,
                                                       const std::stop_token& stop = {});

}  // namespace mortise::fabplanner
