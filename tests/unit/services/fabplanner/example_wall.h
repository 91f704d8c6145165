// A wall with more pegs than anybody counts: 16 panels and 31 boards behind them, 1,333 pegs.
#pragma once

#include <string>

#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {

inline Items WallItems() {
  Items items = ExampleItems();
  items["items/plywood-18"].size = {2.5, 1.25, 0.018};
  items["items/plank-20"] = {.name = "items/plank-20",
                             .title = "Planed pine 20 × 90",
                             .kind = ItemKind::kBoard,
                             .size = {2.4, 0.09, 0.02},
                             .price = {"EUR", 6}};
  return items;
}

// Panels side by side along x; a board behind the middle of each, which comes first, and behind
// each joint, which holds two panels together. 43 pegs a board.
inline Design ExampleWall() {
  constexpr int kPanels = 16, kBoards = 2 * kPanels - 1, kPegs = 43;
  const double width = 0.4, height = 2.2, thick = 0.018, board = 0.09, deep = 0.02;
  Design design;
  for (int i = 0; i < kPanels; ++i) {
    design.parts.push_back(BoxPart("panel " + std::to_string(i + 1), "items/plywood-18",
                                   CutProcess::kJigsaw, {i * width, 0, 0},
                                   {(i + 1) * width, thick, height}, 2, 1));
    design.parts.back().title = "Panel";
  }
  for (int k = 0; k < kBoards; ++k) {
    const double middle = width / 2 * (k + 1);
    const std::string name = "board " + std::to_string(k + 1);
    design.parts.push_back(BoxPart(name, "items/plank-20", CutProcess::kChopSaw,
                                   {middle - board / 2, thick, 0},
                                   {middle + board / 2, thick + deep, height}, 2, 1));
    design.parts.back().title = "Board";
    const bool is_joint = k % 2 == 1;
    for (int p = 0; p < kPegs; ++p) {
      // Behind a joint every other peg goes into the panel to the right.
      const int panel = k / 2 + (is_joint && p % 2 == 1 ? 1 : 0);
      const double side = is_joint ? (p % 2 == 1 ? 0.02 : -0.02) : 0;
      Peg peg = MakePeg(is_joint ? "joints" : "middles", "panel " + std::to_string(panel + 1), name,
                        {middle + side, thick, 0.05 + p * 0.05}, Eigen::Vector3d::UnitY(), 0.012,
                        is_joint ? 2 : 1);
      peg.length = 0.025;
      design.pegs.push_back(peg);
    }
  }
  return design;
}

}  // namespace mortise::fabplanner
