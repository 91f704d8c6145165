// Snaps a component to the body of a working model: finds its place and sizes there from where it
// was dropped (thesis §5.5).
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// What the thesis leaves open, in one table.
struct SnapOptions {
  // K: how many planes of the body are tried for each constraint of the original design. Where K
  // to the power of the constraints is more than `combinations`, it is lowered.
  int planes = 4;
  double combinations = 5000;
  // m. A plane of the component that the original design says nothing of is aligned with the
  // nearest parallel plane of the body, if that is no further away.
  double threshold = 0.03;
  // m. Parts are neighbours if their boxes are no further apart: in the original, to be looked at
  // at all; in the body, across the plane, to be preferred for faces that lay against each other.
  double reach = 0.1;
  // m. Constraints of the original are met by planes that are no further away, or half as far as
  // the component's part is large along the axis: what is dropped far from everything is left
  // there.
  double furthest = 0.1;
  // What of a size a level plane of the original is worth: where it costs more than to stretch all
  // of the component along the axis by as much, it is left.
  double stretch = 0.5;
  // How many combinations may be refused for where the component would lie with them. After that
  // the last constraint is given up, and those of the others are looked at.
  int refusals = 50;
};

// Two planes that are one after snapping.
struct Alignment {
  std::string component_element;
  std::string component_plane;  // "x minimum", or a prominent plane's name
  std::string body_element;
  std::string body_plane;
  Axis axis = Axis::kX;        // their normal
  double moved_by = 0;         // m, how far the component's plane was moved along the axis
  bool from_original = false;  // else found as prominent planes near each other
  std::string text;            // for people
};

struct Snapped {
  Design component;
  std::vector<Alignment> alignments;
};

// Returns the component snapped to the body. `original` is the design that the component is a
// sub-tree of, as drawn, or null where there is none; the component's parts are known in it by
// their names and lie where they are drawn there.
//
// - Coplanarities between the component and principal parts of the rest of the original that touch
//   it, or share a connection with it, become constraints: faces that lay against each other first
//   (original_constraints.h). Rows that others imply, or the component's relationships determine,
//   are left out.
// - Each may be met by one of the K planes of the body nearest to the component's plane, that have
//   the same normal as the original's: minimum faces for minimum faces, so that a shelf stays
//   between its sides; broad faces for broad ones, if there are any. Of all combinations the one is
//   taken whose design is nearest to the present one, (5.2), exactly. Nearness is that of
//   MovableSet.
// - Our own: a combination is taken only if where the component then lies, each face that lay
//   against another lies across from a part of the body whose face it meets, and no part runs into
//   the body deeper than where it was dropped, or than it does into the rest of the original. As
//   few contacts as possible are given up for that. Planes that were only level are left where it
//   would cost more than `stretch` says.
// - Planes that are free still are aligned with the nearest parallel plane within the threshold,
//   nearest first, in all rest poses, unless that has parts run into each other.
//
// The component moves freely in space. FAILED_PRECONDITION, SNAP_FAR, if the body is further from
// it than all of the two are large: nothing there to snap to.
absl::StatusOr<Snapped> Snap(const Design& component, const Design* original, const Design& body,
                             const SnapOptions& options = {});

}  // namespace mortise::composer
