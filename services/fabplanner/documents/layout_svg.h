// Draws cutting diagrams: boards and sheets with their parts, dimensioned in millimetres, as SVG.
#pragma once

#include <string>

#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns all boards, under a heading for each item and section. Boards cut alike (the same lengths
// in the same order) are drawn once, with their number. Trims and offcuts are hatched.
std::string BoardsSvg(const FabricationPlan& plan);

// Returns all sheets, each with its outlines, their sizes and positions. Sheets cut alike are drawn
// once.
std::string SheetsSvg(const FabricationPlan& plan);

}  // namespace mortise::fabplanner
