// Turns designs by right angles, as people turn what they place in a room: any of the 24 ways that
// a box can lie.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// A turn is a rotation matrix whose entries are 0, 1 and -1.

// Returns the turn of these quarter turns, one after the other, each about an axis of space,
// against the clock as seen from where the axis points to.
Eigen::Matrix3d TurnOf(const std::vector<Axis>& quarter_turns);

// Returns the fewest quarter turns that make up a turn, of several such the first by their axes.
// They are none for the identity, and five at most.
std::vector<Axis> QuarterTurnsOf(const Eigen::Matrix3d& turn);

// Returns the box turned about the origin.
parametric::BoundingBox Turned(const parametric::BoundingBox& box, const Eigen::Matrix3d& turn);

// Returns the assembly turned about the origin. Boxes, limits, item axes, prominent planes, joints
// with their rest poses, and shapes (DrawnShape::turn) turn with it, and names stay. A component is
// turned together with the design that it is compared to (Original).
parametric::Assembly Turned(parametric::Assembly assembly, const Eigen::Matrix3d& turn);

// Returns the design as it is now, sizes and all, turned about the middle of its box, and then
// moved so that the middle of the lower side of its box is where it was. `turned` is its assembly
// turned so. Fails as FeasibleSet::Nearest.
absl::StatusOr<Design> Turned(const Design& design,
                              std::shared_ptr<const parametric::ParametricAssembly> turned,
                              const Eigen::Matrix3d& turn);

}  // namespace mortise::composer
