// Maps in the store: what they are of, and how good. Their values are in blobs (stored_map.h).
#pragma once

#include "common/resources/collection.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::interpolator {

// Records hold mortise.v1.DesignMap by the map's id, which is that of the operation that built it.
inline constexpr resources::Collection<v1::DesignMap> kMaps{
    .names = "maps", .kind = "maps", .event = "map"};

}  // namespace mortise::interpolator
