// Finds boards and sheets that are cut alike, which drawings and lists tell once. Private to this
// folder.
#pragma once

#include <string>
#include <vector>

#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Stock that is cut alike: the first of it, and the labels of all.
struct AlikeStock {
  std::size_t first = 0;
  std::vector<std::string> labels;
};

// Return them in order of the first of each. Copies of a part count as the part.
std::vector<AlikeStock> AlikeBoards(const std::vector<BoardLayout>& boards);
std::vector<AlikeStock> AlikeSheets(const std::vector<SheetLayout>& sheets);

// Returns "board-1", or "board-1, 3, 5, 7 (4 alike)".
std::string LabelsText(const AlikeStock& alike);

// Returns the name of the part whose copy has the label: "leg_1" for "leg_1.2".
std::string WithoutCopy(const std::string& label);

}  // namespace mortise::fabplanner
