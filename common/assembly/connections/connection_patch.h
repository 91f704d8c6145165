// Finds where principal elements meet: the contact patches of connections (thesis §3.6). They are
// exact for boxes.
#pragma once

#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"

namespace mortise::parametric {

// The kinds of places that connecting elements are placed against.
enum class PatchKind {
  kContact,  // two principals touch, or reach into each other, over an area
  kGap,      // two principals that only connecting elements hold together: what lies between them
  kWhole,    // of a connection with one principal: that principal's box
};

// "contact", "gap" or "whole".
const char* PatchKindName(PatchKind kind);

struct ConnectionPatch {
  PatchKind kind = PatchKind::kContact;
  int first = 0;   // principal element: index into ElementConnection::elements
  int second = 0;  // another; the same of kWhole
  // The axis across which they meet. Along it the pieces have no extent where faces touch.
  Axis normal = Axis::kX;
  // The box in which each two parts meet, m; only in a kContact.
  std::vector<BoundingBox> pieces;
  BoundingBox region;  // m, around the pieces; else the gap or the whole
  double area = 0;     // m², of the pieces, seen along their normals
};

// Returns the boxes of an element's parts when it fills `box`: one box, or as many as its pattern
// has room for. O(parts).
std::vector<BoundingBox> PartsIn(const Element& element, const BoundingBox& box);

// Returns how two principals meet if they fill these boxes: their contact, or else the gap. Parts
// further apart than `tolerance`, m, do not touch; nor do parts that meet in an edge or a corner
// only, over no more than `least`, m. The indices of the result are left 0. O(parts · parts).
ConnectionPatch FindPatch(const Element& first, const BoundingBox& first_box, const Element& second,
                          const BoundingBox& second_box, double tolerance, double least);

// Returns the patch between two boxes: along each axis it reaches over what they share, or else
// over the gap.
ConnectionPatch GapBetween(const BoundingBox& first, const BoundingBox& second);

// Returns the patch of a connection with one principal.
ConnectionPatch WholeOf(const BoundingBox& box);

}  // namespace mortise::parametric
