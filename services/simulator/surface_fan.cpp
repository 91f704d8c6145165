#include "services/simulator/surface_fan.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <map>

#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

// Where less than this share of a side leads along the surface, it has no direction along it.
constexpr double kLeastAlong = 1e-3;

// Sides of a face are 01, 12, 20, and their middles 3, 4, 5.
std::array<int, 2> MiddlesBeside(int corner) { return {3 + corner, 3 + (corner + 2) % 3}; }

Eigen::Vector3d NormalAt(const GradientMatrix& positions, int place) {
  return EvaluateTriangle(positions, FacePlace(place)).normal;
}

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

// The normal of the surface at a corner: the mean of its faces'.
Eigen::Vector3d MeanNormal(const std::vector<GradientMatrix>& positions,
                           std::span<const FaceNode> corners) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t f = 0; f < corners.size(); ++f) {
    normal += NormalAt(positions[f], corners[f].place);
  }
  return normal.normalized();
}

// Whether each of the middles beside the corner is there twice.
bool Surrounds(const PartSurface& surface, std::span<const FaceNode> samples) {
  std::map<int, int> times;
  for (const FaceNode& sample : samples) ++times[surface.nodes()(sample.place, sample.face)];
  for (const auto& [node, count] : times) {
    if (count != 2) return false;
  }
  return times.size() >= 3;
}

}  // namespace

std::optional<SurfaceFan> SurfaceFan::Around(const mesh::TetrahedralMesh& mesh,
                                             const PartSurface& surface, int slot) {
  if (!mesh.IsQuadratic() || !surface.SharpEdgesAt(slot).empty()) return std::nullopt;
  SurfaceFan fan(surface, surface.At(slot));
  for (const FaceNode& corner : fan.corners_) {
    if (corner.place > 2) return std::nullopt;
    fan.positions_.push_back(FacePositions(mesh, surface, corner.face));
    for (const int place : MiddlesBeside(corner.place)) {
      fan.samples_.push_back({corner.face, place});
    }
  }
  if (!Surrounds(surface, fan.samples_) || fan.LeavesSurface()) return std::nullopt;
  fan.samples_.insert(fan.samples_.end(), fan.corners_.begin(), fan.corners_.end());
  return fan;
}

bool SurfaceFan::LeavesSurface() const {
  const Eigen::Vector3d normal = MeanNormal(positions_, corners_);
  for (std::size_t f = 0; f < corners_.size(); ++f) {
    for (const int place : MiddlesBeside(corners_[f].place)) {
      const Eigen::Vector3d away = positions_[f].col(place) - positions_[f].col(corners_[f].place);
      if (!(normal.cross(away).norm() > kLeastAlong * away.norm())) return true;
    }
  }
  return false;
}

std::vector<SurfaceFan::Share> SurfaceFan::Shares(
    const std::vector<GradientMatrix>& positions) const {
  const Eigen::Vector3d corner = positions[0].col(corners_[0].place);
  const Eigen::Vector3d normal = MeanNormal(positions, corners_);
  const Eigen::Vector3d first = normal.unitOrthogonal(), second = normal.cross(first);
  // Rows 1, x, y of the samples, x and y as far from the corner as they are in space.
  const std::size_t middles = 2 * corners_.size();
  const auto face_of = [middles](std::size_t s) { return s < middles ? s / 2 : s - middles; };
  Eigen::Matrix3Xd rows(3, samples_.size());
  double scale = 0;
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const Eigen::Vector3d away = positions[face_of(s)].col(samples_[s].place) - corner;
    const Eigen::Vector2d along(away.dot(first), away.dot(second));
    rows.col(s) << 1, s < middles ? along * (away.norm() / along.norm()) : along;
    scale += away.norm() / static_cast<double>(middles);
  }
  rows.bottomRows<2>() /= scale;
  const Eigen::Vector3d at_corner =
      (rows * rows.transpose()).ldlt().solve(Eigen::Vector3d::UnitX());
  std::vector<Share> shares;
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const Eigen::Vector3d own = NormalAt(positions[face_of(s)], samples_[s].place);
    shares.push_back({at_corner.dot(rows.col(s)),
                      Eigen::Quaterniond::FromTwoVectors(own, normal).toRotationMatrix()});
  }
  return shares;
}

Vector6d SurfaceFan::Stress(std::span<const Vector6d> at_samples) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const std::vector<Share> shares = Shares(positions_);
  for (std::size_t s = 0; s < shares.size(); ++s) {
    const Eigen::Matrix3d& turn = shares[s].turn;
    sum += shares[s].weight * turn * StressTensor(at_samples[s]) * turn.transpose();
  }
  return VectorOf(sum);
}

std::vector<Vector6d> SurfaceFan::Directions(const Vector6d& direction) const {
  std::vector<Vector6d> directions;
  for (const auto& [weight, turn] : Shares(positions_)) {
    directions.push_back(DualVector(weight * turn.transpose() * DualTensor(direction) * turn));
  }
  return directions;
}

void SurfaceFan::AddDerivative(const Vector6d& direction, std::span<const Vector6d> at_samples,
                               Eigen::Matrix3Xd& by_position) const {
  const Eigen::Matrix3d dual = DualTensor(direction);
  const auto value = [&](const std::vector<GradientMatrix>& positions) {
    double sum = 0;
    const std::vector<Share> shares = Shares(positions);
    for (std::size_t s = 0; s < shares.size(); ++s) {
      const Eigen::Matrix3d& turn = shares[s].turn;
      sum += shares[s].weight *
             (turn * StressTensor(at_samples[s]) * turn.transpose()).cwiseProduct(dual).sum();
    }
    return sum;
  };
  // Where each node is among the faces.
  std::map<int, std::vector<FaceNode>> nodes;
  for (std::size_t f = 0; f < corners_.size(); ++f) {
    for (int place = 0; place < 6; ++place) {
      nodes[surface_.nodes()(place, corners_[f].face)].push_back({static_cast<int>(f), place});
    }
  }
  const double step = 1e-5 * (positions_[0].col(0) - positions_[0].col(1)).norm();
  for (const auto& [node, places] : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<GradientMatrix> ahead = positions_, behind = positions_;
      for (const auto& [face, place] : places) {
        ahead[static_cast<std::size_t>(face)](axis, place) += step;
        behind[static_cast<std::size_t>(face)](axis, place) -= step;
      }
      by_position(axis, node) += (value(ahead) - value(behind)) / (2 * step);
    }
  }
}

}  // namespace mortise::simulator
