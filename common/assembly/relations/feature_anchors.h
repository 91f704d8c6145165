// Shapes that are stretched in pieces: a bore goes by the rod in it, a mortise by its tenon, and
// the shoulders of a tenon stay against the post it enters, while the wood beside them grows. So
// what an item fixes does not hold the size of whatever it fits into.
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

// By an element's first part and axis, how many others fit into it: so many places might keep their
// share of its size (KnownConflicts::shares_kept).
using FitCounts = std::map<std::pair<int, Axis>, int>;

// What comes of holding the levels of shapes.
struct FeatureAnchors {
  std::vector<Relationship> relationships;
  FitCounts fits;
};

// Gives `elements` their held levels, and shapes that are divided there. Only levels that divide a
// shape (mesh::ShapeLevel) are held, and none of what is to be fitted (KnownConflicts::fitted).
// Along each axis, from the smallest element to the largest:
//
// - a bore as wide as what lies in it, rod or shank, or up to twice as wide, and what else reaches
// from one plane
//   of a neighbour to another, as a mortise does: both ends go by the neighbour's. Its middle keeps
//   its share of the element's size, as far as KnownConflicts::shares_kept says;
// - a plane of a neighbour that the element, which is no wider, enters: what lies against it, a
//   shoulder, goes by that plane;
// - the end of a neighbour that is let into the element: the bottom of its bore goes by it,
//   and keeps its share as the middles of bores do;
// - bores with nothing in them, up to half as wide as their element: they keep their width, and
//   their middle its share; and blind ones with nothing at their bottom their depth. Slots with
//   round ends are bores too: across, they go by the bolts in them, which may move along.
//
// Bores that overlap along an axis go by the largest thing in them. What lies between two such
// places, or beside the first and the last, keeps at least half its share; between a shoulder or
// bottom and the end beside it, half its drawn length. In one place is what is apart by no more
// than `tolerance`, m, and what triangles may miss. What an element's own drawing gives as play
// stays as it is. O(p² f²) for p parts of f levels and planes.
FeatureAnchors AnchorFeatures(const Assembly& assembly, std::vector<Element>& elements,
                              const Contacts& contacts, double tolerance,
                              const KnownConflicts& known_conflicts, ShapeFeatures& known);

// What is round about an axis of the design, from one side of its box to the other, stays so.
std::vector<Relationship> KeepRound(const Assembly& assembly, const std::vector<Element>& elements,
                                    double tolerance, ShapeFeatures& known);

}  // namespace mortise::parametric
