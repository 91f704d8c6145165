// The planes that a component has when a joint of its original design moves all of it, as the hinge
// of a door does: the joint is between the component and the rest, so that only the original tells
// of it (thesis §5.5, Figure 5-5).
#pragma once

#include <vector>

#include "services/composer/snapping/plane.h"

namespace mortise::composer {

// Returns those faces of the component's principal elements that bound it in the rest poses of such
// joints, and that the pose moves. They are functions of the component's parameters, in space: the
// joint's centre keeps its distance from a face of the component along each axis along which it
// does so in all designs that the original may be. Planes that depend on a centre otherwise, and
// those of rows of which the component has only some, are left out. Poses whose rotations do not
// take axes to axes have none. O(poses · elements²).
std::vector<DesignPlane> PlanesInPosesOf(const Design& original, const Design& component);

}  // namespace mortise::composer
