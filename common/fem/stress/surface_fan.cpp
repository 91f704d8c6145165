#include "common/fem/stress/surface_fan.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <map>

#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

// Where less than this share of a side leads along the surface, it has no direction along it.
constexpr double kMinAlong = 1e-3;

// Sides of a face are 01, 12, 20, and their middles 3, 4, 5.
std::array<int, 2> MiddlesBeside(int corner) { return {3 + corner, 3 + (corner + 2) % 3}; }

Eigen::Vector3d NormalAt(const GradientMatrix& positions, int place) {
  return EvaluateTriangle(positions, FacePlace(place)).normal;
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
      if (!(normal.cross(away).norm() > kMinAlong * away.norm())) return true;
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
  return StressOf(Shares(positions_), at_samples);
}

std::vector<Vector6d> SurfaceFan::Directions(const Vector6d& direction) const {
  return DirectionsOf(Shares(positions_), direction);
}

void SurfaceFan::AddDerivative(const Vector6d& direction, std::span<const Vector6d> at_samples,
                               Eigen::Matrix3Xd& by_position) const {
  PlacedFaces at{{}, positions_};
  for (const FaceNode& corner : corners_) at.faces.push_back(corner.face);
  AddShareDerivative(
      surface_, at, [this](const std::vector<GradientMatrix>& moved) { return Shares(moved); },
      direction, at_samples, by_position);
}

}  // namespace mortise::simulator
