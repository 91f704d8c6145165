// The file of a map: stored_map.proto, in the folder of blobs.
//
// Maps of metrics would fit into the store (ten metrics of a thousand samples are 80 kB), but they
// grow with the budget past what a record may hold, and what is to come beside the metrics is far
// larger. A blob (blob_folder.h) already has what a map needs: it is written beside its place and
// renamed, it is named by its checksum, and that is checked when it is read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/maps/interpolation_map.h"

namespace mortise::interpolator {

// Writes the maps of all structures: the same bytes for the same maps.
std::string SerializeMap(const std::vector<maps::MapContent>& structures);

// Reads what SerializeMap wrote. DATA_LOSS when the bytes are not such.
absl::StatusOr<std::vector<maps::InterpolationMap>> ParseMap(std::string_view bytes);

}  // namespace mortise::interpolator
