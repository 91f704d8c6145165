// Where two parts meet as drawn, and whether what stretches them leaves them there as they are:
// what need not be looked at again in every design.
#pragma once

#include <array>
#include <optional>

#include "common/mesh/box_stretch.h"
#include "common/mesh/drawn_shape.h"
#include "common/parametric/assembly.h"

namespace mortise::parametric {

// A part in its box.
struct StretchedPart {
  BoundingBox box;
  mesh::BoxStretch stretch;
};

// The common region of two parts' boxes as drawn, m.
class MeetingRegion {
 public:
  // `shape_a`, `shape_b`: null for what fills its box. Boxes that are further apart than
  // `tolerance`, m, have no region. O(T) for T triangles.
  MeetingRegion(const BoundingBox& a, const mesh::DrawnShape* shape_a, const BoundingBox& b,
                const mesh::DrawnShape* shape_b, double tolerance);

  // Whether the parts, stretched so, stand to each other as drawn: along all axes both are
  // stretched by one map in the region, to within `same`, m; or along all but one, along which both
  // go straight on, as a rod does through its board, and begin and end in the order they did, at
  // the same distance where they touch. It is enough that one does, if it reaches beyond the other
  // at both ends, as a pin does through a tube.
  // False also where that cannot be told. O(levels).
  bool StandsAsDrawn(const StretchedPart& a, const StretchedPart& b, double same) const;

 private:
  // From where to where a part reaches along an axis where the other is across it, m, as drawn.
  struct Reach {
    double from = 0, to = 0;
    bool is_straight = true;
  };
  using Reaches = std::array<std::optional<Reach>, 3>;

  Reaches ReachesOf(const BoundingBox& box, const mesh::DrawnShape* shape) const;
  bool IsOneMap(const StretchedPart& a, const StretchedPart& b, int axis, double same) const;
  bool IsKept(double drawn, double now, double same) const;
  bool KeepsOrder(const StretchedPart& a, const StretchedPart& b, int axis, double same) const;

  BoundingBox drawn_a_, drawn_b_;
  double tolerance_;
  std::optional<BoundingBox> region_;
  Reaches reaches_a_, reaches_b_;
};

}  // namespace mortise::parametric
