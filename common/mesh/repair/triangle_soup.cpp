#include "common/mesh/repair/triangle_soup.h"

// Boost's own headers include others of Boost that warn of themselves.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <numeric>
#include <utility>

#include "common/base/errors.h"
#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/point_merger.h"
#include "common/mesh/surface_check.h"

namespace mortise::mesh {

// An edge with one triangle, as that triangle runs along it.
struct TriangleSoup::Border {
  int triangle;
  int from;
  int to;
  int opposite;
  std::vector<std::pair<double, int>> vertices;  // on it, with how far along it they lie
};

namespace {

namespace geometry = boost::geometry;
using Point = geometry::model::point<double, 3, geometry::cs::cartesian>;
using Box = geometry::model::box<Point>;
using Segment = geometry::model::segment<Point>;

constexpr std::size_t kMaxPieces = 4;     // that triangles are divided into on the mean
constexpr std::size_t kMaxLookedAt = 16;  // vertices near edges, to each of those pieces

Point ToPoint(const Eigen::Vector3d& place) { return {place.x(), place.y(), place.z()}; }

// A triangle without its turn and its first corner, and whether they were turned for that.
struct Unturned {
  std::array<int, 3> corners;
  bool is_backward;
  std::size_t triangle;
};

Unturned UnturnedOf(const Eigen::Vector3i& triangle, std::size_t index) {
  std::array<int, 3> corners{triangle[0], triangle[1], triangle[2]};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  const bool is_backward = corners[1] > corners[2];
  if (is_backward) std::swap(corners[1], corners[2]);
  return {corners, is_backward, index};
}

}  // namespace

std::vector<TriangleSoup::Border> TriangleSoup::BordersOf(const CutSurface& surface) {
  std::vector<Border> borders;
  for (const SurfaceEdge& edge : surface.edges()) {
    if (edge.triangles() != 1) continue;
    const OpenMesh::HalfedgeHandle inner(2 * edge.first);
    const auto next = surface.mesh().next_halfedge_handle(inner);
    const auto after = surface.mesh().next_halfedge_handle(next);
    borders.push_back({surface.TriangleAt(edge, 0),
                       surface.CornerOf(inner),
                       surface.CornerOf(next),
                       surface.CornerOf(after),
                       {}});
  }
  return borders;
}

TriangleSoup::TriangleSoup(const SurfaceMesh& surface, double tolerance)
    : tolerance_(tolerance),
      most_triangles_(kMaxPieces * (static_cast<std::size_t>(surface.triangles.cols()) + 100)) {
  const Eigen::Vector3d corner = surface.vertices.rowwise().minCoeff();
  PointMerger merger(tolerance);
  std::vector<int> merged(static_cast<std::size_t>(surface.vertices.cols()), -1);
  std::vector<int> kept;  // of each vertex of the soup, that of the surface
  for (const auto& triangle : surface.triangles.colwise()) {
    Eigen::Vector3i corners;
    for (int k = 0; k < 3; ++k) {
      int& index = merged[static_cast<std::size_t>(triangle[k])];
      if (index < 0) {
        // From the corner on, so that cells have small numbers.
        index = merger.IndexOf(surface.vertices.col(triangle[k]) - corner);
        if (index == static_cast<int>(kept.size())) {
          kept.push_back(triangle[k]);
        } else {
          ++merged_vertices_;
        }
      }
      corners[k] = index;
    }
    triangles_.push_back(corners);
  }
  vertices_ = surface.vertices(Eigen::all, kept);
}

int TriangleSoup::DropDegenerate() {
  return static_cast<int>(std::erase_if(triangles_, [this](const Eigen::Vector3i& triangle) {
    return IsDegenerate(vertices_.col(triangle[0]), vertices_.col(triangle[1]),
                        vertices_.col(triangle[2]));
  }));
}

int TriangleSoup::DropRepeated() {
  std::vector<Unturned> all;
  for (std::size_t t = 0; t < triangles_.size(); ++t) all.push_back(UnturnedOf(triangles_[t], t));
  std::sort(all.begin(), all.end(), [](const Unturned& a, const Unturned& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.triangle < b.triangle;
  });
  std::vector<bool> is_dropped(triangles_.size(), false), is_both_ways(triangles_.size(), false);
  for (auto first = all.begin(); first != all.end();) {
    auto next = first + 1;
    for (; next != all.end() && next->corners == first->corners; ++next) {
      is_dropped[next->triangle] = true;
      if (next->is_backward != first->is_backward) is_both_ways[first->triangle] = true;
    }
    first = next;
  }
  const auto drop = [this](const std::vector<bool>& dropped) {
    std::size_t t = 0;
    return static_cast<int>(std::erase_if(
        triangles_, [&](const Eigen::Vector3i&) { return static_cast<bool>(dropped[t++]); }));
  };
  // Of those left.
  std::vector<bool> is_wall;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (!is_dropped[t]) is_wall.push_back(is_both_ways[t]);
  }
  int count = drop(is_dropped);
  if (std::find(is_wall.begin(), is_wall.end(), true) == is_wall.end()) return count;
  const CutSurface surface(vertices_, ToMatrix(triangles_));
  for (const SurfaceEdge& edge : surface.edges()) {
    if (edge.triangles() <= 2) continue;
    for (int i = 0; i < edge.triangles(); ++i) {
      if (is_wall[static_cast<std::size_t>(surface.TriangleAt(edge, i))]) {
        return count + drop(is_wall);
      }
    }
  }
  return count;
}

// Notes at every border which border vertices lie on it. Edges are asked for vertices, not the
// other way: of many long edges that cross, each is near few vertices, but each vertex is in the
// boxes of most edges.
absl::Status TriangleSoup::FindVerticesOn(std::vector<Border>& borders) const {
  std::vector<int> vertices;
  for (const Border& border : borders) vertices.insert(vertices.end(), {border.from, border.to});
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<std::pair<Box, int>> places;
  for (const int v : vertices) {
    const Eigen::Vector3d place = vertices_.col(v);
    places.emplace_back(
        Box(ToPoint(place.array() - tolerance_), ToPoint(place.array() + tolerance_)), v);
  }
  const geometry::index::rtree<std::pair<Box, int>, geometry::index::quadratic<16>> tree(places);
  std::size_t looked_at = 0, found = triangles_.size();
  for (Border& border : borders) {
    const Eigen::Vector3d from = vertices_.col(border.from), to = vertices_.col(border.to);
    const double length = (to - from).norm();
    const Eigen::Vector3d along = (to - from) / length;
    const Segment segment(ToPoint(from), ToPoint(to));
    for (auto near = tree.qbegin(geometry::index::intersects(segment)); near != tree.qend();
         ++near) {
      const Eigen::Vector3d offset = vertices_.col(near->second) - from;
      const double at = along.dot(offset);
      const bool is_on_it =
          (offset - at * along).norm() <= tolerance_ && at > tolerance_ && at < length - tolerance_;
      if (is_on_it) border.vertices.emplace_back(at, near->second);
      found += is_on_it ? 1 : 0;
      if (found > most_triangles_ || ++looked_at > kMaxLookedAt * most_triangles_) {
        return InvalidField("surface", "has too many vertices that lie on edges of triangles");
      }
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<int> TriangleSoup::SplitAtVertices() {
  std::vector<Border> borders = BordersOf(CutSurface(vertices_, ToMatrix(triangles_)));
  MORTISE_RETURN_IF_ERROR(FindVerticesOn(borders));
  std::erase_if(borders, [](const Border& border) { return border.vertices.empty(); });
  std::sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
    return std::pair(a.triangle, a.from) < std::pair(b.triangle, b.from);
  });
  // Another edge of the same triangle is found again when this one is divided.
  borders.erase(
      std::unique(borders.begin(), borders.end(),
                  [](const Border& a, const Border& b) { return a.triangle == b.triangle; }),
      borders.end());
  for (Border& border : borders) {
    std::sort(border.vertices.begin(), border.vertices.end());
    int from = border.from;
    for (const auto& [at, to] : border.vertices) {
      triangles_.emplace_back(from, to, border.opposite);
      from = to;
    }
    triangles_[static_cast<std::size_t>(border.triangle)] = {from, border.to, border.opposite};
  }
  return static_cast<int>(borders.size());
}

SurfaceMesh TriangleSoup::Surface() const {
  std::vector<int> index(static_cast<std::size_t>(vertices_.cols()), -1);
  for (const Eigen::Vector3i& triangle : triangles_) {
    for (const int vertex : triangle) index[static_cast<std::size_t>(vertex)] = 0;
  }
  std::vector<int> used;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = static_cast<int>(used.size());
    used.push_back(static_cast<int>(v));
  }
  return {vertices_(Eigen::all, used), ToMatrix(triangles_).unaryExpr([&index](int vertex) {
            return index[static_cast<std::size_t>(vertex)];
          })};
}

Eigen::Matrix3Xi ToMatrix(const std::vector<Eigen::Vector3i>& triangles) {
  Eigen::Matrix3Xi matrix(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    matrix.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return matrix;
}

}  // namespace mortise::mesh
