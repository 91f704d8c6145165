// Parts of lumber with sloped ends, as triangles, to test with.
#pragma once

#include <string>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {

// A part that reaches over `size` (length, width, thickness; m) with its length and thickness along
// axes of the design. It lies about its middle.
inline Part SlopedLumber(const std::string& name, const std::string& item,
                         const Eigen::Vector3d& size, const CutEnds& ends, int length_axis,
                         int thickness_axis) {
  Part part;
  part.name = name;
  part.title = name;
  part.item = item;
  part.process = CutProcess::kChopSaw;
  part.size = size;
  part.length_axis = length_axis;
  part.thickness_axis = thickness_axis;
  const Eigen::Vector2d section = size.tail<2>();
  const double front = -size.x() / 2 + ReachOf(ends.front, section);
  const double rear = size.x() / 2 - ReachOf(ends.rear, section);
  const Eigen::Vector3d u = Eigen::Vector3d::Unit(length_axis);
  const Eigen::Vector3d w = Eigen::Vector3d::Unit(thickness_axis);
  const Eigen::Vector3d v = w.cross(u);
  part.vertices.resize(3, 8);
  for (int corner = 0; corner < 4; ++corner) {  // counter-clockwise seen against u
    const double at_v = (corner == 0 || corner == 3 ? -0.5 : 0.5) * section.x();
    const double at_w = (corner < 2 ? -0.5 : 0.5) * section.y();
    const auto along = [&](double middle, const EndSlope& end) {
      return middle + end.across * at_v + end.through * at_w;
    };
    part.vertices.col(corner) = u * along(front, ends.front) + v * at_v + w * at_w;
    part.vertices.col(corner + 4) = u * along(rear, ends.rear) + v * at_v + w * at_w;
  }
  part.triangles.resize(3, 12);
  part.triangles << 0, 0, 4, 4, 0, 0, 1, 1, 2, 2, 3, 3,  //
      2, 3, 5, 6, 1, 5, 2, 6, 3, 7, 0, 4,                //
      1, 2, 6, 7, 5, 4, 6, 5, 7, 6, 4, 7;
  return part;
}

}  // namespace mortise::fabplanner
