#include "services/retrieval/fit/query_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/descriptors/surface_samples.h"
#include "services/retrieval/fit/welded_surface.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kReachOfNoise = 2;      // a patch reaches as far as so many deviations
constexpr double kMaxReach = 0.05;       // of the diagonal
constexpr std::size_t kMaxOfPatch = 80;  // triangles

// The mean of a patch of the surface around a triangle.
struct Patch {
  Vector3d middle = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
};

// Walks over the triangles around one; reuses its memory.
class PatchWalk {
 public:
  PatchWalk(const WeldedSurface& surface, double reach)
      : surface_(surface),
        reach_(reach),
        centres_(3, surface.triangles.cols()),
        visited_(static_cast<std::size_t>(surface.triangles.cols()), -1) {
    for (Index t = 0; t < surface.triangles.cols(); ++t) {
      centres_.col(t) = surface.vertices(Eigen::all, surface.triangles.col(t)).rowwise().mean();
    }
  }

  Patch Around(int triangle, const Vector3d& place) {
    const int mark = ++walks_;
    walk_.assign(1, triangle);
    visited_[static_cast<std::size_t>(triangle)] = mark;
    for (std::size_t i = 0; i < walk_.size() && walk_.size() < kMaxOfPatch; ++i) {
      for (int k = 0; k < 3; ++k) {
        const int next = surface_.neighbours(k, walk_[i]);
        if (next < 0 || visited_[static_cast<std::size_t>(next)] == mark) continue;
        visited_[static_cast<std::size_t>(next)] = mark;
        if ((centres_.col(next) - place).norm() <= reach_) walk_.push_back(next);
      }
    }
    Patch patch;
    if (walk_.size() == 1) return {place, surface_.areas.col(triangle).normalized()};
    double area = 0;
    for (const int t : walk_) {
      const double size = surface_.areas.col(t).norm();
      patch.normal += surface_.areas.col(t);
      patch.middle += size * centres_.col(t);
      area += size;
    }
    patch.middle /= area;
    if (patch.normal.norm() <= 1e-6 * area) patch.normal = surface_.areas.col(triangle);
    patch.normal.normalize();
    // Along the surface the point stays where it is.
    patch.middle = place + patch.normal.dot(patch.middle - place) * patch.normal;
    return patch;
  }

 private:
  const WeldedSurface& surface_;
  const double reach_;
  Eigen::Matrix3Xd centres_;
  std::vector<int> visited_;  // by triangle: the last walk that came there
  std::vector<int> walk_;
  int walks_ = 0;
};

}  // namespace

absl::StatusOr<QueryPoints> MakeQueryPoints(const mesh::SurfaceMesh& surface, Index count,
                                            std::uint64_t seed) {
  MORTISE_ASSIGN_OR_RETURN(const WeldedSurface welded, Weld(surface));
  QueryPoints points;
  points.diagonal = welded.diagonal;
  points.noise = EstimateNoise(welded);
  const SurfaceSamples samples(welded.vertices, welded.triangles, count, seed);
  points.places.resize(3, count);
  points.smoothed.resize(3, count);
  points.normals.resize(3, count);
  points.sided.resize(static_cast<std::size_t>(count));
  PatchWalk walk(welded, std::min(kReachOfNoise * points.noise, kMaxReach * welded.diagonal));
  for (Index i = 0; i < count; ++i) {
    const int triangle = samples.TriangleOf(i);
    points.places.col(i) =
        welded.vertices(Eigen::all, welded.triangles.col(triangle)) * samples.BarycentricOf(i);
    const Patch patch = walk.Around(triangle, points.places.col(i));
    points.smoothed.col(i) = patch.middle;
    points.normals.col(i) = patch.normal;
    points.sided[static_cast<std::size_t>(i)] = welded.sided[static_cast<std::size_t>(triangle)];
  }
  return points;
}

QueryPoints EvenPart(const QueryPoints& points, Index count) {
  const Index size = points.size();
  count = std::min(count, size);
  QueryPoints part = points;
  part.places.resize(3, count);
  part.smoothed.resize(3, count);
  part.normals.resize(3, count);
  part.sided.resize(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) {
    const Index from = i * size / count;
    part.places.col(i) = points.places.col(from);
    part.smoothed.col(i) = points.smoothed.col(from);
    part.normals.col(i) = points.normals.col(from);
    part.sided[static_cast<std::size_t>(i)] = points.sided[static_cast<std::size_t>(from)];
  }
  return part;
}

}  // namespace mortise::retrieval
