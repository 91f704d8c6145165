// Says how the ends of a part of lumber run, and how a chop saw is set to cut them.
//
// A board lies flat: u runs along it, v across its width, w upwards through its thickness, v and w
// from its middle line. An end is a plane u = u0 + across v + through w. The saw's table turns by
// the mitre about w, then its blade tilts by the bevel about the line in which it meets the table,
// so that
//
//     across = tan(mitre), through = tan(bevel) / cos(mitre).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// How an end runs; square where both are 0.
struct EndSlope {
  double across = 0;   // du/dv
  double through = 0;  // du/dw

  bool operator==(const EndSlope&) const = default;
};

// The two ends of a part of lumber, in the order of u.
struct CutEnds {
  EndSlope front;
  EndSlope rear;

  bool operator==(const CutEnds&) const = default;
};

// By how much an end may miss a plane, or a square end, over the whole section, m.
inline constexpr double kEndTolerance = 1e-6;

inline bool IsSquare(const EndSlope& end) { return end == EndSlope{}; }
inline bool AreSquare(const CutEnds& ends) { return IsSquare(ends.front) && IsSquare(ends.rear); }

// Return the settings of the saw, rad, below π/2 in size.
double MitreOf(const EndSlope& end);
double BevelOf(const EndSlope& end);

// Returns the end that a saw so set cuts.
EndSlope SlopeOf(double mitre, double bevel);

// Returns how far the end's foremost and last points lie from where it crosses the middle line, m,
// on a board of `section`, its width and thickness, m.
double ReachOf(const EndSlope& end, const Eigen::Vector2d& section);

// Returns how long a cut of `kerf` is, measured along the board, m.
double KerfAlong(const EndSlope& end, double kerf);

// Return the ends of a part that is turned by half a turn about the board's length, width or
// thickness: with its identity all ways in which it can lie on a board.
CutEnds TurnedAboutLength(const CutEnds& ends);
CutEnds TurnedAboutWidth(const CutEnds& ends);
CutEnds TurnedAboutThickness(const CutEnds& ends);

// Returns the ends of a part that two plane cuts of its blank give: its section is a rectangle all
// along its length. Nothing for all other parts. Ends that are square within kEndTolerance are
// exactly square.
std::optional<CutEnds> EndsOf(const Part& part);

// Returns what people call the end: "square", "45°", "bevel 30°", "45°, bevel 30°". Degrees to a
// tenth.
std::string EndText(const EndSlope& end);

// Returns what people call the ends, front first: "ends 45° and square", "both ends 45°"; empty
// where both are square.
std::string EndsText(const CutEnds& ends);

// Returns "22.5°" for an angle in rad, to a tenth of a degree.
std::string DegreesText(double angle);

}  // namespace mortise::fabplanner
