#include "common/fem/stress/stress_shares.h"

#include <map>

namespace mortise::simulator {
namespace {

Vector6d VectorOf(const Eigen::Matrix3d& tensor) {
  Vector6d vector;
  vector << tensor(0, 0), tensor(1, 1), tensor(2, 2), tensor(0, 1), tensor(1, 2), tensor(0, 2);
  return vector;
}

// The tensor whose product with a stress tensor is direction · σ.
Eigen::Matrix3d DualTensor(Vector6d direction) {
  direction.tail<3>() /= 2;
  return StressTensor(direction);
}

Vector6d DualVector(const Eigen::Matrix3d& tensor) {
  Vector6d direction = VectorOf(tensor);
  direction.tail<3>() *= 2;
  return direction;
}

}  // namespace

Vector6d StressOf(std::span<const StressShare> shares, std::span<const Vector6d> stresses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t s = 0; s < shares.size(); ++s) {
    const Eigen::Matrix3d& turn = shares[s].turn;
    sum += shares[s].weight * turn * StressTensor(stresses[s]) * turn.transpose();
  }
  return VectorOf(sum);
}

std::vector<Vector6d> DirectionsOf(std::span<const StressShare> shares, const Vector6d& direction) {
  std::vector<Vector6d> directions;
  for (const auto& [weight, turn] : shares) {
    directions.push_back(DualVector(weight * turn.transpose() * DualTensor(direction) * turn));
  }
  return directions;
}

void AddShareDerivative(
    const PartSurface& surface, const PlacedFaces& at,
    const std::function<std::vector<StressShare>(const std::vector<GradientMatrix>&)>& shares_at,
    const Vector6d& direction, std::span<const Vector6d> stresses, Eigen::Matrix3Xd& by_position) {
  // Where each node is among the faces.
  std::map<int, std::vector<FaceNode>> nodes;
  for (std::size_t f = 0; f < at.faces.size(); ++f) {
    for (int place = 0; place < surface.nodes().rows(); ++place) {
      nodes[surface.nodes()(place, at.faces[f])].push_back({static_cast<int>(f), place});
    }
  }
  const double step = 1e-5 * (at.positions[0].col(0) - at.positions[0].col(1)).norm();
  for (const auto& [node, places] : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<GradientMatrix> ahead = at.positions, behind = at.positions;
      for (const auto& [face, place] : places) {
        ahead[static_cast<std::size_t>(face)](axis, place) += step;
        behind[static_cast<std::size_t>(face)](axis, place) -= step;
      }
      const Vector6d change =
          StressOf(shares_at(ahead), stresses) - StressOf(shares_at(behind), stresses);
      by_position(axis, node) += direction.dot(change) / (2 * step);
    }
  }
}

}  // namespace mortise::simulator
