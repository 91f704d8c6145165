// The shape of one part that is a placed prism with named faces.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mortise::mesh {

// A polygon extruded along w = u × v. A corner (a, b) of the outline lies at origin + a u + b v,
// and at that + height w on the far side.
struct PartShape {
  std::string name;                                  // not empty, unique in an assembly
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();      // unit vectors at a right angle
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
  Eigen::Matrix2Xd outline;  // 2 × N, m, counter-clockwise, simple, N ≥ 3
  double height = 0;         // m, > 0
  // The N + 2 names of the face on each outline edge (corner i to i + 1), of the base and of the
  // cap.
  std::vector<std::string> face_names;
};

}  // namespace mortise::mesh
