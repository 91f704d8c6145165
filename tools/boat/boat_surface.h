// Draws the surface of the toy boat that ships (collection/cage_templates/boat.textproto): the file
// has its numbers, this says where they come from. A tug: a hull with a raked stem and a deck sunk
// behind a bulwark, on it a house, and on that a bridge with windows and a funnel.
#pragma once

#include "common/templates/cage/cage_template.h"

namespace mortise::parametric {

// The boat at the defaults of its parameters, rounded to hundredths of a millimetre. X points to
// the bow, Z up; the keel lies at z = 0 amidships, the transom at x = 0. Symmetric about y = 0,
// exactly.
CageSurface DrawBoat();

}  // namespace mortise::parametric
