// Directions of their own that the unknowns of some nodes are counted in.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::simulator {

// Directions in which the displacement of some nodes is counted instead of x, y, z: what a support
// along an inclined normal needs. Displacement in space = axes · displacement in the frame.
struct NodeFrames {
  std::vector<int> index;             // nodes: which of `axes`, or -1; empty where no node has one
  std::vector<Eigen::Matrix3d> axes;  // rotations; columns are the directions

  bool empty() const { return index.empty(); }

  // Turn 3 × nodes vectors in space into components along the frames, and back.
  Eigen::Matrix3Xd ToFrames(Eigen::Matrix3Xd vectors) const;
  Eigen::Matrix3Xd ToSpace(Eigen::Matrix3Xd vectors) const;
};

}  // namespace mortise::simulator
