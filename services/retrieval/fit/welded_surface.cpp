#include "services/retrieval/fit/welded_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "common/base/errors.h"
#include "common/mesh/point_merger.h"
#include "services/retrieval/fit/mesh_points.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Matrix3Xi;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kSamePlace = 1e-7;  // of the diagonal
constexpr double kNoArea = 1e-12;    // of the diagonal squared
constexpr double kMinVolume = 3e-4;  // of the area to the power of 3/2: less is flat
constexpr int kFewVertices = 50;     // of whose noise nothing can be said
constexpr double kMuchLess = 0.3;
constexpr std::size_t kFewTriangles = 50;  // of whose noise nothing can be said
// The median of NoiseAround's least with one, two and three neighbours and noise of a deviation of
// 1: as simulated on grids of four kinds, which differ by 5 %.
constexpr std::array<double, 3> kMedianOfLeast = {0.68, 0.27, 0.143};

// The corners' columns, if they are there and finite.
bool IsUsable(const mesh::SurfaceMesh& surface, const Vector3i& corners) {
  for (const int corner : corners) {
    if (!surface.vertices.col(corner).allFinite()) return false;
  }
  return true;
}

// An edge of a triangle, from its corner `side` to the next.
struct Side {
  int low = 0, high = 0;
  int triangle = 0, side = 0;
  bool upwards = false;  // from low to high
};

std::vector<Side> SidesOf(const Matrix3Xi& triangles) {
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(3 * triangles.cols()));
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangles(k, t), to = triangles((k + 1) % 3, t);
      sides.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

// Turns triangles over.
class Turner {
 public:
  explicit Turner(WeldedSurface* surface)
      : surface_(*surface), seen_(static_cast<std::size_t>(surface->triangles.cols())) {
    surface_.neighbours.setConstant(3, surface_.triangles.cols(), -1);
    alike_.setOnes(3, surface_.triangles.cols());
    Join();
  }

  void Run() {
    surface_.sided.assign(seen_.size(), false);
    for (int t = 0; t < surface_.triangles.cols(); ++t) {
      if (!seen_[static_cast<std::size_t>(t)]) TurnPiece(t);
    }
  }

 private:
  void Join() {
    const std::vector<Side> sides = SidesOf(surface_.triangles);
    for (std::size_t i = 0; i < sides.size();) {
      std::size_t end = i + 1;
      while (end < sides.size() && sides[end].low == sides[i].low &&
             sides[end].high == sides[i].high) {
        ++end;
      }
      if (end - i == 2 && sides[i].triangle != sides[i + 1].triangle) {
        const bool alike = sides[i].upwards != sides[i + 1].upwards;
        for (const auto& [one, other] :
             {std::pair(sides[i], sides[i + 1]), std::pair(sides[i + 1], sides[i])}) {
          surface_.neighbours(one.side, one.triangle) = other.triangle;
          alike_(one.side, one.triangle) = alike ? 1 : 0;
        }
      }
      i = end;
    }
  }

  // The piece of a triangle, each with whether it is turned over.
  void TurnPiece(int first) {
    std::vector<int> piece = {first};
    std::vector<bool> over = {false};
    seen_[static_cast<std::size_t>(first)] = true;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const int next = surface_.neighbours(k, piece[i]);
        if (next < 0 || seen_[static_cast<std::size_t>(next)]) continue;
        seen_[static_cast<std::size_t>(next)] = true;
        piece.push_back(next);
        over.push_back(over[i] == (alike_(k, piece[i]) == 1));
      }
    }
    Vector3d middle = Vector3d::Zero();
    double area = 0;
    for (const int t : piece) {
      middle += surface_.areas.col(t).norm() * CentreOf(t);
      area += surface_.areas.col(t).norm();
    }
    middle /= area;
    double volume = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const Vector3d out = (over[i] ? -1 : 1) * surface_.areas.col(piece[i]);
      volume += out.dot(CentreOf(piece[i]) - middle) / 3;
    }
    const bool bounds = std::abs(volume) > kMinVolume * area * std::sqrt(area);
    for (std::size_t i = 0; i < piece.size(); ++i) {
      surface_.sided[static_cast<std::size_t>(piece[i])] = bounds;
      if (over[i] != (bounds && volume < 0)) TurnOver(piece[i]);
    }
  }

  Vector3d CentreOf(int t) const {
    return surface_.vertices(Eigen::all, surface_.triangles.col(t)).rowwise().mean();
  }

  void TurnOver(int t) {
    std::swap(surface_.triangles(1, t), surface_.triangles(2, t));
    std::swap(surface_.neighbours(0, t), surface_.neighbours(2, t));
    surface_.areas.col(t) *= -1;
  }

  WeldedSurface& surface_;
  Matrix3Xi alike_;  // whether the neighbour goes the other way along the edge
  std::vector<bool> seen_;
};

// How high the far corner of the neighbour over side k is above the plane of a triangle, in
// standard deviations of noise in each of the four corners.
double HeightOfNeighbour(const WeldedSurface& surface, int triangle, int k) {
  const Vector3i corners = surface.triangles.col(triangle);
  const Vector3i other = surface.triangles.col(surface.neighbours(k, triangle));
  int far = 0;
  while (far < 2 && (other[far] == corners[k] || other[far] == corners[(k + 1) % 3])) ++far;
  const Vector3d a = surface.vertices.col(corners[0]);
  const Vector3d u = surface.vertices.col(corners[1]) - a;
  const Vector3d v = surface.vertices.col(corners[2]) - a;
  const Vector3d place = surface.vertices.col(other[far]) - a;
  const double twice = u.cross(v).norm();
  const Vector3d normal = u.cross(v) / twice;
  const double b = place.cross(v).dot(normal) / twice, c = u.cross(place).dot(normal) / twice;
  return normal.dot(place) / std::sqrt(1 + b * b + c * c + (1 - b - c) * (1 - b - c));
}

// What the triangle and those around it tell of noise: the least of the heights of its neighbours
// and of their differences, as an edge of what is shown bends but some of the neighbours away, and
// a round surface bends all of them alike.
std::optional<double> NoiseAround(const WeldedSurface& surface, int triangle) {
  std::vector<double> heights;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (surface.neighbours(k, triangle) < 0) continue;
    const double height = HeightOfNeighbour(surface, triangle, k);
    least = std::min(least, std::abs(height));
    for (const double other : heights) {
      least = std::min(least, std::abs(height - other) * std::numbers::sqrt2 / 2);
    }
    heights.push_back(height);
  }
  if (heights.empty()) return std::nullopt;
  return least / kMedianOfLeast[heights.size() - 1];
}

// By how far vertices lie from the middle of those around them.
double NoiseOfVertices(const WeldedSurface& surface) {
  const Index count = surface.vertices.cols();
  Matrix3Xd normals = Matrix3Xd::Zero(3, count), sums = Matrix3Xd::Zero(3, count);
  Eigen::VectorXd neighbours = Eigen::VectorXd::Zero(count);
  std::vector<bool> within(static_cast<std::size_t>(count), true);
  for (Index t = 0; t < surface.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int vertex = surface.triangles(k, t), next = surface.triangles((k + 1) % 3, t);
      normals.col(vertex) += surface.areas.col(t);
      sums.col(vertex) += surface.vertices.col(next);
      neighbours[vertex] += 1;
      if (surface.neighbours(k, t) >= 0) continue;
      within[static_cast<std::size_t>(vertex)] = within[static_cast<std::size_t>(next)] = false;
    }
  }
  // Normals of one vertex are noisy themselves: those around it have a say.
  Matrix3Xd around = normals;
  for (const auto& corners : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) around.col(corners[k]) += normals.col(corners[(k + 1) % 3]);
  }
  std::vector<double> offsets;
  for (Index v = 0; v < count; ++v) {
    if (!within[static_cast<std::size_t>(v)] || neighbours[v] < 3) continue;
    const Vector3d off = surface.vertices.col(v) - sums.col(v) / neighbours[v];
    // A vertex and the mean of n others differ by more than noise, by this much.
    const double expected = std::sqrt(1 + 1 / neighbours[v]);
    offsets.push_back(std::abs(off.dot(around.col(v).normalized())) / expected);
  }
  if (offsets.size() < kFewVertices) return 0;
  const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
  std::nth_element(offsets.begin(), middle, offsets.end());
  constexpr double kDeviationOfMedian = 1.4826;  // of a normal distribution's absolute values
  return kDeviationOfMedian * *middle;
}

// By how far the neighbours of triangles are out of their planes: the median over the area.
double NoiseOfTriangles(const WeldedSurface& surface) {
  std::vector<std::pair<double, double>> estimates;  // each with the area it speaks for
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    if (const std::optional<double> noise = NoiseAround(surface, t)) {
      estimates.emplace_back(*noise, surface.areas.col(t).norm());
    }
  }
  if (estimates.size() < kFewTriangles) return 0;
  std::sort(estimates.begin(), estimates.end());
  double whole = 0, below = 0;
  for (const auto& [noise, area] : estimates) whole += area;
  for (const auto& [noise, area] : estimates) {
    below += area;
    if (below >= whole / 2) return noise;
  }
  return estimates.back().first;
}

}  // namespace

absl::StatusOr<WeldedSurface> Weld(const mesh::SurfaceMesh& surface) {
  if (surface.triangles.cols() == 0) return InvalidField("query", "has no triangles");
  if (surface.triangles.minCoeff() < 0 || surface.triangles.maxCoeff() >= surface.vertices.cols()) {
    return InvalidField("query", "has triangles with vertices that do not exist");
  }
  Eigen::AlignedBox3d box;
  for (const auto& corners : surface.triangles.colwise()) {
    if (!IsUsable(surface, corners)) continue;
    for (const int corner : corners) box.extend(surface.vertices.col(corner));
  }
  WeldedSurface welded;
  welded.diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  if (!(welded.diagonal > 0) || !std::isfinite(welded.diagonal)) {
    return InvalidField("query", "has no triangle with an area");
  }
  mesh::PointMerger points(kSamePlace * welded.diagonal);
  std::vector<Vector3i> triangles;
  std::vector<int> merged(static_cast<std::size_t>(surface.vertices.cols()), -1);
  for (const auto& corners : surface.triangles.colwise()) {
    if (!IsUsable(surface, corners)) continue;
    if (AreaVector(surface.vertices, corners).norm() <=
        kNoArea * welded.diagonal * welded.diagonal) {
      continue;
    }
    Vector3i triangle;
    for (int k = 0; k < 3; ++k) {
      int& index = merged[static_cast<std::size_t>(corners[k])];
      if (index < 0) index = points.IndexOf(surface.vertices.col(corners[k]) - box.min());
      triangle[k] = index;
    }
    const bool has_corners =
        triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0];
    if (has_corners) triangles.push_back(triangle);
  }
  if (triangles.empty()) return InvalidField("query", "has no triangle with an area");
  welded.vertices = points.Points().colwise() + box.min();
  const auto count = static_cast<Index>(triangles.size());
  welded.triangles.resize(3, count);
  welded.areas.resize(3, count);
  for (Index t = 0; t < count; ++t) {
    welded.triangles.col(t) = triangles[static_cast<std::size_t>(t)];
    welded.areas.col(t) = AreaVector(welded.vertices, welded.triangles.col(t));
  }
  Turner(&welded).Run();
  return welded;
}

double EstimateNoise(const WeldedSurface& surface) {
  // Corners and round places of coarse meshes are far from the middle of those around them: where
  // triangles know of much less noise, it is these.
  const double of_vertices = NoiseOfVertices(surface), of_triangles = NoiseOfTriangles(surface);
  return of_triangles < kMuchLess * of_vertices ? of_triangles : of_vertices;
}

}  // namespace mortise::retrieval
