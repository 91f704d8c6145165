// Finds the holes for screws, bolts and pins that are parts of the design, and the marks for
// connecting parts that have none of them.
//
// A connector that is long and round lies along a line. Of each part to drill that the line passes:
//   pegs and pins   a hole of their diameter, 1 mm deeper than they reach, or through;
//   wood screws     a pilot hole of 0.7 thread diameters in the part where the tip ends, as deep as
//                   the tip; half a millimetre more than the thread in all parts before it. Both to
//                   half a millimetre;
//   metric threads  a clearance hole to ISO 273, medium series; where the bolt ends in the part, a
//                   hole to tap: thread diameter less pitch.
// Measures "pilot_diameter" and "clearance_diameter" of an item go before the rule. A head that
// lies below the surface gets a counterbore of its "head_diameter", or two thread diameters.
#pragma once

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns the diameter of the clearance hole of a metric thread, m: ISO 273, medium series; a tenth
// more than the thread for threads it does not have.
double ClearanceOf(double thread_diameter);

// Adds the holes and marks of the design's connecting parts to the plan, in their order. Holes of
// one connector follow it from its head to its tip. Only what is cut, and boards, sheets and rods
// that are bought, are drilled, and those only by what is thinner than they are. No hole comes out
// at the far side but those that are said to be through.
void AddFastenerHoles(const Design& design, const Items& items, FabricationPlan* plan);

}  // namespace mortise::fabplanner
