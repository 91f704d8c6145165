#include "common/fem/linear/node_frames.h"

#include <utility>

namespace mortise::simulator {
namespace {

Eigen::Matrix3Xd Turn(const NodeFrames& frames, bool to_space, Eigen::Matrix3Xd vectors) {
  for (std::size_t v = 0; v < frames.index.size(); ++v) {
    if (frames.index[v] < 0) continue;
    const Eigen::Matrix3d& axes = frames.axes[frames.index[v]];
    const Eigen::Vector3d before = vectors.col(v);
    if (to_space) {
      vectors.col(v) = axes * before;
    } else {
      vectors.col(v) = axes.transpose() * before;
    }
  }
  return vectors;
}

}  // namespace

Eigen::Matrix3Xd NodeFrames::ToFrames(Eigen::Matrix3Xd vectors) const {
  return Turn(*this, false, std::move(vectors));
}

Eigen::Matrix3Xd NodeFrames::ToSpace(Eigen::Matrix3Xd vectors) const {
  return Turn(*this, true, std::move(vectors));
}

}  // namespace mortise::simulator
