// The volume that the triangles of a shape with curved faces miss, or have too much at hollow ones.
#pragma once

#include "common/mesh/drawn_shape.h"

namespace mortise::mesh {

// m³: the volume of the exact solid less that of its triangles, in a stretch at whose levels the
// shape is divided. As drawn, the sum is known. Where it belongs is estimated: two flat pieces of
// one face that meet at an angle are taken to miss what a circular arc stands out from its chord,
// which each piece of the stretch then makes larger or smaller. Of cylinders that are evenly
// divided the estimate is exact. What it misses in all is shared out by it, and so is as far off as
// faces with different factors are estimated unequally well: for balls, by some tenths of what the
// triangles miss. O(T log T) for T triangles.
double MissedVolumeIn(const DrawnShape& shape, const BoxStretch& stretch);

}  // namespace mortise::mesh
