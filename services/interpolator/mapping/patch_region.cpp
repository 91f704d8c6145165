#include "services/interpolator/mapping/patch_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace mortise::interpolator {
namespace {

constexpr double kCornerAngle = 150 * M_PI / 180;
constexpr std::size_t kFewestCorners = 3;

// Returns the angle of a patch at each vertex of its boundary, rad.
std::vector<double> AnglesOf(const LaidSurface& laid, const LaidSurface::Patch& patch) {
  std::vector<double> at_vertex(patch.vertices.size(), 0);
  for (Eigen::Index t = 0; t < patch.disk.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](int i) -> Eigen::Vector3d {
        const int vertex = patch.disk((k + i) % 3, t);
        return laid.surface.vertices.col(patch.vertices[static_cast<std::size_t>(vertex)]);
      };
      const Eigen::Vector3d next = corner(1) - corner(0), last = corner(2) - corner(0);
      at_vertex[static_cast<std::size_t>(patch.disk(k, t))] +=
          std::atan2(next.cross(last).norm(), next.dot(last));
    }
  }
  std::vector<double> angles;
  for (const int vertex : patch.boundary) {
    angles.push_back(at_vertex[static_cast<std::size_t>(vertex)]);
  }
  return angles;
}

// Returns the lengths of a patch's boundary from vertex to vertex, as shares of it all.
std::vector<double> SharesOf(const LaidSurface& laid, const LaidSurface::Patch& patch) {
  std::vector<double> shares;
  double sum = 0;
  const std::size_t count = patch.boundary.size();
  const auto point = [&](std::size_t i) -> Eigen::Vector3d {
    const int vertex = patch.boundary[i % count];
    return laid.surface.vertices.col(patch.vertices[static_cast<std::size_t>(vertex)]);
  };
  for (std::size_t i = 0; i < count; ++i) {
    shares.push_back((point(i + 1) - point(i)).norm());
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

// Returns the indices on the boundary of the points among whom corners may be, which begin paths.
std::vector<std::size_t> PointsOf(const PatchLayout& layout, std::size_t patch) {
  std::vector<std::size_t> points;
  std::size_t next = 0;
  for (const int directed : layout.walks[patch]) {
    points.push_back(next);
    next += layout.source.paths[static_cast<std::size_t>(directed / 2)].size() - 1;
  }
  return points;
}

Eigen::Vector2d OnCircle(double turns) {
  return {std::cos(2 * M_PI * turns), std::sin(2 * M_PI * turns)};
}

}  // namespace

Eigen::Matrix2Xd RegionBoundary(const std::vector<BoundarySide>& sides, double bulge) {
  std::vector<Eigen::Vector2d> positions;
  double turns = 0;
  for (const BoundarySide& side : sides) {
    const Eigen::Vector2d from = OnCircle(turns), to = OnCircle(turns + side.share);
    const Eigen::Vector2d chord = to - from;
    const Eigen::Vector2d outward(chord.y(), -chord.x());
    // The circle leaves its chord at an angle of half of what it turns.
    const double slope = std::tan(bulge * M_PI * side.share);
    for (const double place : side.places) {
      positions.push_back(sides.size() < kFewestCorners
                              ? OnCircle(turns + place * side.share)
                              : from + place * chord + slope * place * (1 - place) * outward);
    }
    turns += side.share;
  }
  Eigen::Matrix2Xd boundary(2, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    boundary.col(static_cast<Eigen::Index>(i)) = positions[i];
  }
  return boundary;
}

Eigen::Matrix2Xd RegionOf(const PatchLayout& layout, std::size_t patch) {
  const LaidSurface::Patch& ours = layout.source.patches[patch];
  const LaidSurface::Patch& theirs = layout.target.patches[patch];
  const std::vector<double> our_angles = AnglesOf(layout.source, ours);
  const std::vector<double> their_angles = AnglesOf(layout.target, theirs);
  const std::vector<double> our_shares = SharesOf(layout.source, ours);
  const std::vector<double> their_shares = SharesOf(layout.target, theirs);
  std::vector<std::size_t> corners;
  for (const std::size_t i : PointsOf(layout, patch)) {
    if ((our_angles[i] + their_angles[i]) / 2 < kCornerAngle) corners.push_back(i);
  }
  if (corners.size() < kFewestCorners) corners = {0};
  const std::size_t count = our_shares.size();
  std::vector<BoundarySide> sides;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::size_t end = c + 1 < corners.size() ? corners[c + 1] : corners[0] + count;
    BoundarySide side;
    for (std::size_t i = corners[c]; i < end; ++i) {
      side.places.push_back(side.share);
      side.share += (our_shares[i % count] + their_shares[i % count]) / 2;
    }
    for (double& place : side.places) place /= side.share;
    sides.push_back(std::move(side));
  }
  const Eigen::Matrix2Xd from_corner = RegionBoundary(sides);
  Eigen::Matrix2Xd boundary(2, from_corner.cols());
  for (Eigen::Index i = 0; i < from_corner.cols(); ++i) {
    boundary.col((i + static_cast<Eigen::Index>(corners[0])) % from_corner.cols()) =
        from_corner.col(i);
  }
  return boundary;
}

}  // namespace mortise::interpolator
