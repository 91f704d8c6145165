// The sources of page/ as one text, which has "@@MAP@@" and "@@PACKS@@" for what is known of a map.
// Private to this folder.
#pragma once

#include <string_view>

namespace mortise::cli {

std::string_view PageSource();

}  // namespace mortise::cli
