// Says where two parts meet as drawn, and whether what stretches them leaves them there as they
// are. Such parts need not be looked at again in every design.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/mesh/shapes/box_stretch.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::parametric {

// A part in its box.
struct StretchedPart {
  BoundingBox box;
  mesh::BoxStretch stretch;
};

// The common region of two parts' boxes as drawn, m.
class MeetingRegion {
 public:
  // `shape_a` and `shape_b` are null for parts that fill their box. Boxes that are further apart
  // than `tolerance`, m, have no region. O(T) for T triangles.
  MeetingRegion(const BoundingBox& a, const mesh::DrawnShape* shape_a, const BoundingBox& b,
                const mesh::DrawnShape* shape_b, double tolerance);

  // Whether the parts, stretched so, stand to each other as drawn. They do in two cases:
  // - One map stretches both along all axes in the region, to within `same`, m.
  // - One map stretches both along all axes but one. Along that one both go straight on from step
  //   to step, as a rod and its board do, and all steps are in the order they were. Where steps
  //   touch or overlap, as the head of a screw and its countersink do, one map stretches both. It
  //   is enough that one part goes straight on, if it reaches beyond the other at both ends, as a
  //   pin does through a tube.
  //
  // False also where that cannot be told. O(levels).
  bool StandsAsDrawn(const StretchedPart& a, const StretchedPart& b, double same) const;

 private:
  // A face at right angles to an axis, or a stretch of a part that does not run along it, m as
  // drawn.
  struct Step {
    double low = 0, high = 0;

    bool IsFlat() const;
  };
  // From where to where a part reaches along an axis where the other is across it, m, as drawn.
  struct Reach {
    double from = 0, to = 0;
    // The steps where it begins and ends, or does so in part, as a board does at the bottom of a
    // blind bore. They are in order and apart from each other; in between the part goes straight
    // on. The list is empty if there are too many.
    std::vector<Step> steps;
  };
  using Reaches = std::array<std::optional<Reach>, 3>;

  // Where in the region a part ends before its box does, the core ends with it.
  void ShrinkTo(const BoundingBox& box, const mesh::DrawnShape* shape);
  Reaches ReachesOf(const BoundingBox& box, const mesh::DrawnShape* shape) const;
  static std::vector<Step> Merged(const std::set<std::pair<double, double>>& ends);
  bool IsOneMap(const StretchedPart& a, const StretchedPart& b, int axis, double from, double to,
                double same) const;
  bool IsKept(double drawn, double now, double same) const;
  bool AreKept(const StretchedPart& a, const Step& of_a, const StretchedPart& b, const Step& of_b,
               int axis, double same) const;
  bool KeepsOrder(const StretchedPart& a, const StretchedPart& b, int axis, double same) const;

  BoundingBox drawn_a_, drawn_b_;
  double tolerance_;
  std::optional<BoundingBox> region_;
  BoundingBox core_;  // of the region, what both parts reach into
  Reaches reaches_a_, reaches_b_;
};

}  // namespace mortise::parametric
