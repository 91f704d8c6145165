// Finds the order in which parts are joined: the steps of the assembly (thesis §8.4.2).
//
// The expert gives each connection a priority. Connections of one priority are made in one step,
// lower priorities first; a part comes in with the first step that joins it. A step may build a
// sub-assembly that does not touch what stands already; a later step joins the two.
#pragma once

#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// The most parts that a design may have whose order follows from their shapes: it takes their
// number cubed.
inline constexpr std::size_t kMaxOrderedParts = 2000;

// Returns the steps, numbered 1, 2, 3 …. For a design whose connectors are parts, or that has parts
// of no item or sub-assemblies, they are those of assembly_order.h. Otherwise they go by priority:
// every part is added in exactly one of them. A design of one part without connections has one
// step. INVALID_ARGUMENT if a connection names an unknown part, joins a part to itself or has pegs
// of differing priorities; FAILED_PRECONDITION, reason PARTS_UNCONNECTED, naming parts that the
// connections leave loose. `marks`: of the design's holes. Of those of assembly_order.h:
// RESOURCE_EXHAUSTED past kMaxOrderedParts, CANCELLED once a stop is requested,
// FAILED_PRECONDITION where priorities contradict each other or the shapes.
absl::StatusOr<std::vector<AssemblyStep>> AssemblySteps(const Design& design, const Items& items,
                                                        const std::vector<Mark>& marks = {},
                                                        const std::stop_token& stop = {});

}  // namespace mortise::fabplanner
