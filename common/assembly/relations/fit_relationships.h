// Relates parts that fit into each other: an axle in its bore, a tenon in its mortise, the mitres
// of a frame. Their boxes overlap, so that planes of boxes do not say how they go on touching.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Relates neighbours in a pose of which at least one has a shape. Where the levels of the one
// (Element::levels) lie in a plane or level of the other, they stay there. Otherwise levels and
// planes keep their order, and so do the middles of shapes along axes at whose ends these are not
// flat, as round ones touch what is flat there. What feature anchors say already is left out.
//
// Places count as one if they are apart by no more than `tolerance`, m, and what triangles may
// miss: a level is taken to be where the other's plane is, which is exact. The relationships are
// complete for shapes whose faces are at right angles to the axes, and for cylinders along them.
// O(p²) for p planes and levels of each pair.
std::vector<Relationship> FindFits(const Pose& pose, const Assembly& assembly,
                                   const std::vector<Element>& elements,
                                   const std::set<std::pair<int, int>>& neighbours,
                                   double tolerance);

// Relates the pairs of parts in which `pose` is named, each part an element of its own. Their
// sizes, and the distance of their centres in the pose, stay in proportion along each axis, so that
// both are stretched by the same map and meet as drawn whatever their shape. Where the pose turns
// one of them to no right angle, that map is a scaling: all their sizes and distances stay in one
// proportion. Parts in patterns are left out.
std::vector<Relationship> StretchTogether(const Pose& pose, const Assembly& assembly,
                                          const std::vector<Element>& elements,
                                          const std::set<PosedPair>& fitted);

}  // namespace mortise::parametric
