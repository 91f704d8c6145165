// Chooses which strips are ripped from which plank: one-dimensional packing of widths.
//
// A plank is ripped along its whole length, edge to edge, before its strips are crosscut: a
// guillotine order. Strips of widths w_1 … w_n come out of a plank of width W when
//
//     w_1 + … + w_n + (n − 1) kerf ≤ W.
#pragma once

#include <vector>

namespace mortise::fabplanner {

// A plank with its strips from one edge to the other.
struct RippedPlank {
  std::vector<int> strips;        // indices
  std::vector<double> positions;  // m from the plank's edge, of each strip
};

// Rips every strip once, of as few planks as are found; never more than if each plank gave strips
// of one width only. Widths are > 0 and at most `plank_width` (m), the kerf (m) at least 0.
std::vector<RippedPlank> RipPlanks(const std::vector<double>& widths, double plank_width,
                                   double kerf);

}  // namespace mortise::fabplanner
