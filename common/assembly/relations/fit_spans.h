// Finds stretches of a shape along an axis that something else fits into, or that keep their size
// by themselves: bores, slots and mortises.
#pragma once

#include <vector>

#include "common/assembly/model/bores.h"
#include "common/assembly/polyhedra/linear_form.h"
#include "common/assembly/relations/element_along.h"

namespace mortise::parametric {

struct FitSpan {
  double low = 0, high = 0;  // m, as drawn
  // The element that the span goes by, and the places of that element where it begins and ends; -1
  // for none.
  int by = -1;
  LinearForm low_place, high_place;

  double length() const { return high - low; }
};

// Returns the spans of an element with a shape that levels divide from what is beside them, in
// order and apart from each other. The rules are our own:
//
// - a bore as wide as what lies in it, or up to twice as wide, goes by that; by the largest of
//   several. It may go by the shank of a screw with a head;
// - a span that reaches from one plane of a neighbour to another, as a mortise does, goes by those;
// - a bore with nothing in it, up to half as wide as the element, goes by nothing; nor does a slot,
//   along its length, with nothing as long in it.
//
// Spans that overlap are one, and go by the longest of those that go by something.
std::vector<FitSpan> FindFitSpans(const ElementAlong& along, ShapeFeatures& known);

}  // namespace mortise::parametric
