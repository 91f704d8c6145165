// Stretches shapes in pieces: a bore goes by the rod in it, a mortise by its tenon, and the
// shoulders of a tenon stay against the post it enters, while the wood beside them grows. So an
// item of fixed sizes does not hold the size of whatever it fits into.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/shape_features.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Counts, by an element's first part and axis, how many others fit into it. So many places might
// keep their share of its size (KnownConflicts::shares_kept).
using FitCounts = std::map<std::pair<int, Axis>, int>;

// The relationships that come of anchoring the levels of shapes.
struct FeatureAnchors {
  std::vector<Relationship> relationships;
  FitCounts fits;
};

// Gives `elements` their feature anchors, and shapes that are divided there. Only levels that
// divide a shape (mesh::ShapeLevel) are anchored, and none of elements that are to be fitted
// (KnownConflicts::fitted). The rules are our own. They go along each axis from the smallest
// element to the largest, and anchor:
//
// - a bore as wide as the rod or shank in it, or up to twice as wide, and whatever else reaches
//   from one plane of a neighbour to another, as a mortise does. Both ends go by the neighbour's.
//   The middle keeps its share of the element's size, as far as KnownConflicts::shares_kept says.
// - a shoulder, which lies against a plane of a neighbour that the element, no wider than it,
//   enters. It goes by that plane.
// - the bottom of a bore into which the end of a neighbour is let. It goes by that end, and keeps
//   its share as the middles of bores do.
// - bores with nothing in them, up to half as wide as their element. They keep their width, and
//   their middle its share. Blind ones with nothing at their bottom keep their depth.
//
// Slots with round ends are bores too: across, they go by the bolts in them, which may move along.
//
// Bores that overlap along an axis go by the largest thing in them. What lies between two such
// places, or beside the first and the last, keeps at least half its share; between a shoulder or
// bottom and the end beside it, half its drawn length. Places count as one if they are apart by no
// more than `tolerance`, m, and what triangles may miss. Play that an element's own drawing gives
// stays as it is. O(p² f²) for p parts of f levels and planes.
FeatureAnchors AnchorFeatures(const Assembly& assembly, std::vector<Element>& elements,
                              const Contacts& contacts, double tolerance,
                              const KnownConflicts& known_conflicts, ShapeFeatures& known);

// Keeps round the elements that are round about an axis of the design from one side of their box to
// the other.
std::vector<Relationship> KeepRound(const Assembly& assembly, const std::vector<Element>& elements,
                                    double tolerance, ShapeFeatures& known);

}  // namespace mortise::parametric
