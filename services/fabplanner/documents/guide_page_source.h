// The sources of guide/ as one text, which has "@@TITLE@@", "@@CONTENT@@", "@@SCENE@@" and
// "@@PACK@@" for what a guide says. Private to this folder.
#pragma once

#include <string_view>

namespace mortise::fabplanner {

std::string_view GuidePageSource();

}  // namespace mortise::fabplanner
