// A map as one page that needs neither server nor net: whoever has it moves sliders, and sees
// metrics and shapes of designs at once. What it does there is written in page/.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/explore/exported_structure.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::cli {

// Returns the page (HTML) of these structures of a map, whose trees have all of its metrics. Where
// the map has shapes and structures come with them, the page draws them, with those fields of nodes
// that any of them has. DATA_LOSS where what was received does not fit together, RESOURCE_EXHAUSTED
// where it is more than a browser reads.
absl::StatusOr<std::string> MapPage(const v1::DesignMap& map,
                                    const std::vector<ExportedStructure>& structures);

}  // namespace mortise::cli
