// Lays out outlines on sheets: nesting by bounding rectangles.
//
// Each outline stands for its bounding rectangle, grown by the spacing. Rectangles are placed one
// after another into the free rectangle that they fit best (maximal rectangles, Jylänki 2010),
// sheet by sheet, for several orders and measures of fit; the layout with the fewest sheets, then
// the shortest use of the last one, is kept. Outlines keep their shape: a jigsaw follows any of
// them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::fabplanner {

struct SheetOutline {
  std::string label;                     // for messages
  std::vector<Eigen::Vector2d> outline;  // m, counter-clockwise, at least 3 points
  bool may_turn = false;                 // by 90°: false where the grain runs along the length
};

struct SheetStock {
  double length = 0;  // m, along u
  double width = 0;   // m, along v
};

struct SheetLayoutOptions {
  double trim = 0.010;     // m, left off each edge of the sheet, >= 0
  double spacing = 0.010;  // m, least distance between outlines, >= 0
};

struct PlacedOutline {
  int part = 0;                          // index of the outline
  std::vector<Eigen::Vector2d> outline;  // m, in the sheet's coordinates, counter-clockwise
  bool turned = false;                   // by 90°, counter-clockwise
};

// A sheet with its outlines from its near end (small u) to its far end: the order of cutting.
struct FilledSheet {
  std::vector<PlacedOutline> placements;
};

// Places every outline once. INVALID_ARGUMENT for unusable numbers; FAILED_PRECONDITION, reason
// PART_TOO_LARGE, naming the part and the sizes, if an outline does not fit a sheet by itself.
absl::StatusOr<std::vector<FilledSheet>> LayOutSheets(const std::vector<SheetOutline>& outlines,
                                                      const SheetStock& stock,
                                                      const SheetLayoutOptions& options = {});

}  // namespace mortise::fabplanner
