// Relates parts that meet only in a rest pose, at an angle at which planes along the axes say
// nothing of it: a lid at 100° that leans over a shelf, an arm on its stop.
#pragma once

#include <set>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// How parts that meet in a pose go on.
enum class Meeting {
  kApart,     // they stay on their sides of the plane that separates them as drawn
  kTouching,  // they meet in that plane, at a point that stays within both
};

// Returns relationships of the pairs in which `pose` is named. They are linear in q, as boxes turn
// by the pose's angle only. Pairs whose boxes overlap in the pose as drawn by more than
// `tolerance`, m, are left out, as no plane separates them.
std::vector<Relationship> KeepMeeting(const Pose& pose, const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const std::set<PosedPair>& pairs, Meeting meeting,
                                      double tolerance);

}  // namespace mortise::parametric
