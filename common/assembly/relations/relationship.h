// Geosemantic relationships say what must stay true of a design whatever its parameters. They are
// linear equalities and inequalities in q, each held by one node of the hierarchy (thesis §3.5.1).
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/polyhedra/linear_form.h"

namespace mortise::parametric {

enum class RelationshipKind {
  kCoplanar,    // two planes stay in one
  kConcentric,  // two centres stay level along an axis
  kSymmetric,   // two elements stay mirror images about the centre of a third
  kOrder,       // a plane stays before another
  kSize,        // a size stays fixed, or within its limits
  kRepeat,      // two patterns that touch go on repeating together
  kProportion,  // two elements stretch together: sizes and places stay in proportion; or what
                // fastens a bought part keeps its place on it
};

struct Relationship {
  RelationshipKind kind = RelationshipKind::kCoplanar;
  bool equality = true;  // form(q) = 0, else form(q) <= 0; in metres
  LinearForm form;
  int group = 0;  // of the assembly: the lowest that contains all it relates
  // For people: "'leg 1' z maximum in one plane with 'top' z minimum".
  std::string description;
};

// Two parts of the assembly in a rest pose.
struct PosedPair {
  std::string pose;  // as Pose::name
  int first = 0;
  int second = 0;
};
inline bool operator<(const PosedPair& a, const PosedPair& b) {
  return std::tie(a.pose, a.first, a.second) < std::tie(b.pose, b.first, b.second);
}

// Relationships without which designs are known to go wrong: see design_trial.h and
// feature_anchors.h.
struct KnownConflicts {
  std::set<PosedPair> kept_apart;     // stay clear of each other
  std::set<PosedPair> kept_touching;  // go on touching
  std::set<PosedPair> fitted;         // stretch together (fit_relationships.h)
  // How many of the places where others fit into a shape keep their share of its size, by part and
  // axis. All do where this says nothing.
  std::map<std::pair<int, Axis>, int> shares_kept;
};

// Pairs of elements that touch, by index.
using Contacts = std::vector<std::pair<int, int>>;

// Returns all relationships of a design, those of rest poses included: each joint's rest poses are
// taken one joint at a time, the others as drawn. The drawn parameters satisfy every one.
//
// - coplanar: planes within `tolerance` of each other along an axis;
// - concentric: centres within `tolerance` along an axis;
// - symmetric: two alike elements, level in two axes, about a third element centred between them
//   along the other axis, which is looked for among siblings first, then up the tree. The sizes of
//   the two stay equal;
// - order: an element that lies wholly before another along an axis stays so. All planes of
//   elements that touch keep their order, prominent ones too, so that the contact is not lost; so
//   do those of elements that lie in each other's boxes without touching, so that they stay clear
//   of each other. Elements with parts that are kept apart, or touching, in a pose stay so along
//   the direction that separates their boxes best as drawn, which need not be an axis;
// - fits: of elements that touch or lie in each other's boxes, and of which one has a shape, the
//   levels where shapes turn back stay in one place or keep their order, so that what fits into
//   each other goes on doing so (fit_relationships.h);
// - proportion: parts that are to be fitted, as drawn or in a pose, stretch together, and fasteners
//   keep their place on bought parts (attachments.h);
// - size: sizes stay within the limits of the items;
// - repeat: patterns that touch and repeat as often and as far apart along an axis go on doing so:
//   what fastens each part of a row goes on fastening it.
//
// Every node holds what it needs: cut out, a subtree is constrained among its own elements exactly
// as within the whole, since members of one plane are chained at the lowest node above each two.
// Rows that others imply through such chains are left out. `tolerance` is in metres. O(p² log p)
// for p planes along an axis.
std::vector<Relationship> FindRelationships(const Assembly& assembly,
                                            const std::vector<Element>& elements,
                                            const Contacts& contacts, double tolerance,
                                            const KnownConflicts& known_conflicts = {});

}  // namespace mortise::parametric
