// Turns designs by right angles about the vertical, as people turn what they place in a room.
#pragma once

#include "common/assembly/model/assembly.h"

namespace mortise::composer {

// Returns the assembly turned about the z axis through the origin by so many quarter turns, seen
// from above against the clock; less than 0 with it. Boxes, limits, item axes, prominent planes,
// joints and shapes turn with it, and names stay. A component is turned together with the design
// that it is compared to (Original). What it looks like is only the same shape, stored under the
// same name, where its item axes say how it is turned (DrawnShape::turn).
parametric::Assembly QuarterTurned(parametric::Assembly assembly, int turns);

}  // namespace mortise::composer
