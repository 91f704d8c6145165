// The assembly guide: one HTML page with a picture, the parts and the pegs of each step.
#pragma once

#include <string>
#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns the page. `pictures` has a PNG for each step, which is embedded, so that the page is one
// file that opens anywhere. It prints one step after another without breaking it. `title` is for
// people.
std::string AssemblyGuideHtml(const FabricationPlan& plan, const Design& design, const Items& items,
                              const std::string& title, const std::vector<std::string>& pictures);

}  // namespace mortise::fabplanner
