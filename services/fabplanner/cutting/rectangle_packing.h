// Packs rectangles into equal bins by the maximal-rectangles heuristic. Internal to sheet_layout.
//
// The free space of a bin is kept as all maximal free rectangles, which overlap. Placing a
// rectangle splits those it touches; contained ones are dropped (Jylänki, A thousand ways to pack
// the bin, 2010).
#pragma once

#include <vector>

namespace mortise::fabplanner {

struct RectangleSize {
  double width = 0;
  double height = 0;
  bool may_turn = false;
};

struct PlacedRectangle {
  int index = 0;  // of the rectangle
  double x = 0;   // lower corner
  double y = 0;
  bool turned = false;
};

// Measures how well a rectangle fits a free one: smaller is better.
enum class FitMeasure {
  kShortSide,   // least left over along the shorter leftover side
  kArea,        // least free area left over
  kBottomLeft,  // nearest to the bin's near end
};

// The orders in which rectangles are tried, each from large to small.
enum class PackingOrder { kArea, kLongSide, kWidth, kHeight };

using PackedRectangles = std::vector<std::vector<PlacedRectangle>>;  // one list a bin

// Packs the rectangles. Every one must fit an empty bin of `bin_width` × `bin_height` in an
// orientation it may take.
PackedRectangles PackRectangles(const std::vector<RectangleSize>& rectangles, double bin_width,
                                double bin_height, PackingOrder order, FitMeasure measure);

}  // namespace mortise::fabplanner
