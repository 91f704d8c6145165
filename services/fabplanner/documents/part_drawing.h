// Draws parts that are no plain stock: three views with their sizes.
#pragma once

#include <string>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Gives every part of the plan that is made to shape the names of its drawings, an SVG and an STL;
// parts that are alike share them. Names are of lower-case letters, digits and hyphens.
void NameDrawings(const Design& design, FabricationPlan* plan);

// Whether any part has drawings, and one more drawing for all that have.
bool HasDrawings(const FabricationPlan& plan);
void AddToDrawings(const std::string& file_name, FabricationPlan* plan);

// Returns the part from the front, from above and from the left, in one scale, edges between faces
// that meet at more than 30° and outlines as lines, with the size of its box. What lies behind is
// drawn too, paler.
std::string PartDrawingSvg(const Part& part, const std::string& note);

}  // namespace mortise::fabplanner
