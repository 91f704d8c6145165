// Parts that fit into each other: an axle in its bore, a tenon in its mortise, the mitres of a
// frame. Their boxes overlap, so that planes of boxes do not say how they go on touching.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Of neighbours in a pose, at least one with a shape: where the levels of the one (Element::levels)
// lie in a plane or level of the other, they stay there; otherwise levels and planes keep their
// order, and so do the middles of shapes along axes at whose ends these are not flat, as round ones
// touch what is flat there. What held levels say already is left out. In one place
// is what is apart by no more than `tolerance`, m, and what triangles may miss: a level is taken to
// be where the other's plane is, which is exact. Complete for shapes whose faces are at right
// angles to the axes, and for cylinders along them. O(p²) for p planes and levels of each pair.
std::vector<Relationship> FindFits(const Pose& pose, const Assembly& assembly,
                                   const std::vector<Element>& elements,
                                   const std::set<std::pair<int, int>>& neighbours,
                                   double tolerance);

// Of pairs of parts that `pose` is named in, elements of their own: their sizes, and the distance
// of their centres in the pose, stay in proportion along each axis, so that both are stretched by
// the same map and meet as drawn whatever their shape. Where the pose turns one of them to no right
// angle, that map is a scaling: all their sizes and distances stay in one proportion. Parts in
// patterns are left out.
std::vector<Relationship> StretchTogether(const Pose& pose, const Assembly& assembly,
                                          const std::vector<Element>& elements,
                                          const std::set<PosedPair>& fitted);

}  // namespace mortise::parametric
