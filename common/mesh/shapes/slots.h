// Finds slots with straight sides and round ends, as a mill leaves them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/shapes/round_faces.h"

namespace mortise::mesh {

// Two halves of bores that face each other, with the space between them.
struct Slot {
  int axis = 0;                                      // along which it is milled: 0, 1, 2
  int along = 0;                                     // in which it is longer than wide
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // m as drawn, from the middle of the box
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    // m as drawn
};

// Returns the slots that the round faces of a shape make and that lie along its axes. Each half
// belongs to the nearest that fits. O(F²) for F faces.
std::vector<Slot> SlotsOf(const std::vector<RoundFace>& faces);

}  // namespace mortise::mesh
