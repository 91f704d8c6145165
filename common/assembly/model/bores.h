// Finds what is bored or milled through parts along axes of the design, and what lies in it.
#pragma once

#include <set>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/shape_features.h"

namespace mortise::parametric {

// A round bore, the part of one that widens (a countersink), or a slot with round ends.
struct Bore {
  BoundingBox box;     // as drawn in the design
  int axis = 0;        // along which it is bored: 0, 1, 2
  int slot_axis = -1;  // in which it is longer than wide; -1 of round ones
};

// Returns the bores of a part with a shape.
std::vector<Bore> BoresOf(const AssemblyPart& part, ShapeFeatures& known);

// Returns the boxes of the round pins along an axis, 0, 1 or 2, that a part has, as drawn in the
// design. The shank of a screw is such a pin. A part without a shape has none.
std::vector<BoundingBox> PinsOf(const AssemblyPart& part, int axis, ShapeFeatures& known);

// Whether a size fills the size of a bore but for some play, as bolts have it.
bool Fills(double size, double bore);

// Whether a box reaches into a bore, lies within it across, and fills it there; in a slot it may
// lie anywhere. Places count as one if they are no more than `near` apart, m.
bool LiesIn(const BoundingBox& inner, const Bore& bore, double near);

// Returns the parts of rows of which two or more lie in bores of one part. The bores of that part
// go by them one by one, and do not become more as the parts of a row do. O(f p) for p parts and f
// round faces.
std::set<int> RowsInBoresOfOne(const Assembly& assembly, const std::vector<Element>& elements,
                               double tolerance, ShapeFeatures& known);

}  // namespace mortise::parametric
