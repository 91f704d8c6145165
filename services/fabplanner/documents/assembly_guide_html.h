// The assembly guide as one page: a picture, the fasteners and the parts of each step, and its
// shapes to turn. What it does in a browser is written in guide/.
#pragma once

#include <string>
#include <vector>

#include "services/fabplanner/documents/guide_contents.h"
#include "services/fabplanner/documents/guide_scene.h"

namespace mortise::fabplanner {

// Returns the page. `pictures` has a PNG for each step, which is embedded as `scene` is, so that
// the page is one file that opens anywhere and fetches nothing. It prints one step after another
// without breaking it.
std::string AssemblyGuideHtml(const GuideContents& contents,
                              const std::vector<std::string>& pictures, const GuideScene& scene);

}  // namespace mortise::fabplanner
