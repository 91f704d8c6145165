// Tells where a part is: which stretches of a line it fills, what it touches, what stands in its
// way.
//
// Boxes are judged exactly. Whatever else has faces (prisms of other outlines, drawn shapes) is
// judged by its triangles; ways by a grid of kRays × kRays lines, so that what is thinner than
// their distance may be missed.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// The depth by which parts may reach into each other and still only touch, m.
inline constexpr double kFit = 5e-4;

// The number of lines across a part's way, along each of two axes.
inline constexpr int kRays = 24;

// A stretch of a line, m.
struct Stretch {
  double from = 0;
  double to = 0;
};

class PartSolid {
 public:
  // Screws, hinges and the like count as their boxes.
  explicit PartSolid(const Part& part);

  const Eigen::AlignedBox3d& box() const { return box_; }
  bool is_box() const { return triangles_.cols() == 0; }

  // Returns what of the line through `point` along the axis (0, 1, 2) lies inside, in order.
  std::vector<Stretch> Along(int axis, const Eigen::Vector3d& point) const;

  // Whether the two touch over a face, or reach into each other.
  bool Touches(const PartSolid& other) const;

  // Whether they reach into each other by more than kFit.
  bool Overlaps(const PartSolid& other) const;

  // Whether `other` stands in the way when this moves along the axis, upwards (`sign` 1) or
  // downwards (-1), as far as one likes.
  bool IsBlockedBy(const PartSolid& other, int axis, int sign) const;

 private:
  class Heights;
  bool ReachesInto(const Eigen::AlignedBox3d& box) const;
  // Returns the longest stretch of the upright line through `point` that lies in both.
  double SharedAlong(const PartSolid& other, const Eigen::Vector3d& point) const;

  Eigen::AlignedBox3d box_;
  Eigen::Matrix3Xd vertices_;  // none of a box
  Eigen::Matrix3Xi triangles_;
};

}  // namespace mortise::fabplanner
