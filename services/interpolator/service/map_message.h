// What was sampled, as a message.
#pragma once

#include <vector>

#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/building/map_building.h"
#include "services/interpolator/building/map_plan.h"
#include "services/interpolator/records/stored_map.h"

namespace mortise::interpolator {

// Without name, file, time, tags and, but for why designs are in no mesh, shapes. `structures` are
// what is served of the building's.
v1::DesignMap MakeMap(const v1::MapSpecification& specification, const MapPlan& plan,
                      const MapBuilding& building, const std::vector<StoredStructure>& structures);

}  // namespace mortise::interpolator
