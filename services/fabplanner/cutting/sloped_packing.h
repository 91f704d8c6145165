// Packs parts with sloped ends into the cheapest boards. Private to this folder.
//
// How much of a board parts take depends on what lies beside what (board_chain.h), so this is bin
// packing only nearly. Two packings by bin_packing.h lie on either side of it:
//   - every part takes its length along the middle line and, at each end, half of the least gap
//     that any other part leaves there, less by what ends that count as alike differ: no layout
//     takes less, so the bound of that packing holds. Where all its boards can be chained in their
//     length it is the best layout;
//   - every part takes its rectangle: all its boards can be chained, so the layout never costs more
//     than rectangles would.
// Besides, parts go one after another, longest first, onto the board that they fill most; and
// boards are given up whose parts find place on others. The cheapest layout is kept.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/fabplanner/cutting/bin_packing.h"
#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {

struct SlopedPart {
  int64_t length = 0;  // nm, from its foremost to its last point
  CutEnds ends;
};

// Where a part lies on a board.
struct SlopedPlacement {
  int part = 0;
  int way = 0;        // as Laid has it
  int64_t start = 0;  // nm, of its foremost point, from that of the board's first part
};

struct SlopedBoard {
  int type = 0;
  std::vector<SlopedPlacement> placements;
  int64_t taken = 0;  // nm, from the first part's foremost point to the last one's last
};

struct SlopedPacking {
  std::vector<SlopedBoard> boards;
  int64_t cost = 0;
  int64_t lower_bound = 0;  // no layout costs less
  bool optimal = false;     // cost is proven least
};

// Packs all parts; each fits by itself into the board type of the largest capacity, nm, which is
// what is left of it between the trimmed ends. `section` and `kerf` in metres. The same input gives
// the same layout.
SlopedPacking PackSlopedParts(const std::vector<SlopedPart>& parts,
                              const std::vector<BinType>& types, const Eigen::Vector2d& section,
                              double kerf, int64_t search_steps);

}  // namespace mortise::fabplanner
