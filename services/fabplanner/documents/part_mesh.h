// Makes the triangles of parts and pegs for pictures.
#pragma once

#include "common/render/scene.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// Returns the part as a shape, moved by `offset` (m). Empty if its outline is not a simple polygon.
render::Shape PartShape(const Part& part, const Eigen::Vector3d& offset);

// Returns a round peg from `start` to `end`, m.
render::Shape PegShape(const Eigen::Vector3d& start, const Eigen::Vector3d& end, double diameter);

// Returns a peg of the design, moved by `offset` (m).
render::Shape PegShape(const Peg& peg, const Eigen::Vector3d& offset);

}  // namespace mortise::fabplanner
