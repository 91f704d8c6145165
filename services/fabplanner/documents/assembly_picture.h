// Draws one picture for each step of the assembly: what stands already in grey, the added parts in
// colour and pulled apart along their pegs, with arrows that show how they go in.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns how far a part is drawn from its place in the picture of step `number` (from 1), m. What
// was built in one piece before moves in one piece. The largest piece that stands already (or, in
// the first step, the largest part) stays; the others are pulled away from it against their pegs,
// `distance` for each joint on the way.
Eigen::Vector3d ExplodedOffset(const std::string& part, const Design& design,
                               const std::vector<AssemblyStep>& steps, int number, double distance);

// Returns the PNG of step `number` (from 1), 900 × 675 pixels. The view is the usual one from above
// unless the added parts are seen much better from another corner or from below. Steps that know
// their ways in are drawn by step_picture.h; `holes` say from where their screws come.
absl::StatusOr<std::string> StepPicture(const Design& design, const Items& items,
                                        const std::vector<Hole>& holes,
                                        const std::vector<AssemblyStep>& steps, int number);

}  // namespace mortise::fabplanner
