// Finds what of a model people sit, stand and put things on, and how much that is to bear.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"

namespace mortise::composer {

enum class BearingKind { kSeat, kStep, kShelf, kTop };

// "seat", "step", "shelf" or "top".
const char* BearingKindName(BearingKind kind);

// What a surface of a kind is to bear.
struct BearingLoad {
  double force = 0;          // N, on all of it
  double per_area = 0;       // N/m², besides
  const char* source = "";   // of the two, for people
  double tipping_force = 0;  // N, that must not tip it over; 0: its whole load, in its middle
  double tipping_inset = 0;  // m, from its edge, where that acts
  const char* tipping_source = "";
};

// The list:
//
//   seat   1300 N, the static load of a seat of EN 12520 (domestic seating, persons of 110 kg);
//          tipped by 600 N 60 mm from its edge, as EN 1022 loads it, without that standard's
//          push from the side
//   step   2600 N, the test load of EN 14183 (step stools); tipped by 1500 N 50 mm from its
//          edge: the 150 kg that the standard is for, the place our own
//   shelf  1000 N/m², our own: a row of books; tipped by that alone, in its middle
//   top    1000 N, the vertical static load of EN 12521 (domestic tables); tipped by 300 N 50 mm
//          from its edge, our own: somebody who leans on it
// The standards' figures are taken as what a surface of the kind should bear; whether the piece of
// furniture is one that they are for is not asked.
const BearingLoad& LoadOf(BearingKind kind);

// A horizontal board that faces upwards, or several side by side, as the slats of a seat are.
struct BearingSurface {
  BearingKind kind = BearingKind::kTop;
  std::vector<std::string> parts;
  parametric::BoundingBox box;  // m, around the upper faces; of no height
  double area = 0;              // m², of the upper faces
  std::string because;          // why it is of that kind, for people

  double Load() const { return LoadOf(kind).force + LoadOf(kind).per_area * area; }  // N
};

// Finds the surfaces of an assembly as it is drawn; its floor is at this height, m.
//
// - Parts are taken by their boxes: principal ones, no more than half as thick as they are long and
//   wide, that less than half is covered from above. Those of one group whose upper faces are level
//   within 1 mm are one surface if they cover at least two fifths of the box around them. A surface
//   is at least 0.1 m long and wide.
// - The kind is the first that a word of the name says, of the part, then of its groups, the
//   innermost first: seat, bench; step, tread, rung; shelf, shelves, bottom, tray, deck, floor,
//   base; top, tabletop, worktop, desktop, counter. Else the height says it: what nothing is above
//   for 0.6 m is a seat from 0.35 to 0.52 m, and a top at other heights; the rest are shelves.
//   Backs, sides, doors, lids and roofs by their name are none.
std::vector<BearingSurface> FindBearingSurfaces(const parametric::Assembly& drawn, double floor);

}  // namespace mortise::composer
