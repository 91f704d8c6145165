#include "services/catalog/exchange/shape_turn.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/mesh/mass_properties.h"
#include "common/mesh/point_merger.h"

namespace mortise::catalog {
namespace {

constexpr double kSamePlace = 1e-7;    // m
constexpr double kSameVolume = 1e-7;   // relative
constexpr double kSameInertia = 1e-4;  // relative; curved faces may be cut along other diagonals

// The identity first.
std::vector<Eigen::Matrix3d> RightAngles() {
  std::vector<Eigen::Matrix3d> turns;
  for (int x = 0; x < 3; ++x) {
    for (int z = 2; z >= 0; --z) {
      if (x == z) continue;
      for (const double x_sign : {1.0, -1.0}) {
        for (const double z_sign : {1.0, -1.0}) {
          Eigen::Matrix3d turn;
          turn.col(0) = x_sign * Eigen::Vector3d::Unit(x);
          turn.col(2) = z_sign * Eigen::Vector3d::Unit(z);
          turn.col(1) = turn.col(2).cross(turn.col(0));
          turns.push_back(turn);
        }
      }
    }
  }
  return turns;
}

// Whether all points are among those of `there`.
bool AreAmong(mesh::PointMerger there, Eigen::Index count, const Eigen::Matrix3Xd& points) {
  return std::all_of(points.colwise().begin(), points.colwise().end(),
                     [&](const auto& point) { return there.IndexOf(point) < count; });
}

}  // namespace

std::optional<Eigen::Matrix3d> TurnBetween(const mesh::DrawnShape& from,
                                           const mesh::DrawnShape& to) {
  if (from.fractions.cols() != to.fractions.cols() ||
      from.triangles.cols() != to.triangles.cols() || from.brep.empty() != to.brep.empty() ||
      std::abs(from.volume - to.volume) > kSameVolume * to.volume) {
    return std::nullopt;
  }
  const mesh::SurfaceMesh before = mesh::SurfaceIn(from, from.size);
  const mesh::SurfaceMesh after = mesh::SurfaceIn(to, to.size);
  const Eigen::Matrix3d inertia = mesh::ComputeMassProperties(before).inertia;
  const Eigen::Matrix3d wanted = mesh::ComputeMassProperties(after).inertia;
  mesh::PointMerger places(kSamePlace);
  for (const auto& place : after.vertices.colwise()) places.IndexOf(place);
  const Eigen::Index count = places.Points().cols();
  for (const Eigen::Matrix3d& turn : RightAngles()) {
    if ((turn.cwiseAbs() * from.size - to.size).cwiseAbs().maxCoeff() > kSamePlace) continue;
    const Eigen::Matrix3d turned = turn * inertia * turn.transpose();
    if ((turned - wanted).norm() > kSameInertia * wanted.norm()) continue;
    if (AreAmong(places, count, turn * before.vertices)) return turn;
  }
  return std::nullopt;
}

std::vector<int> FirstAlike(const std::vector<mesh::DrawnShape>& shapes) {
  std::vector<int> first;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto is_alike = [&](std::size_t known) {
      if (first[known] != static_cast<int>(known)) return false;
      const auto turn = TurnBetween(shapes[known], shapes[i]);
      return turn && turn->isIdentity();
    };
    std::size_t known = 0;
    while (known < i && !is_alike(known)) ++known;
    first.push_back(static_cast<int>(known));
  }
  return first;
}

}  // namespace mortise::catalog
