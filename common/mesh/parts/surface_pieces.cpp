#include "common/mesh/parts/surface_pieces.h"

#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <utility>

#include "common/mesh/scenes/mesh_components.h"

namespace mortise::mesh {
namespace {

constexpr double kSameCorner = 1e-6;  // of the scene's diagonal

// An edge of a triangle, by the numbers of its corners, the lower first.
struct TriangleEdge {
  int low = 0, high = 0;
  int triangle = 0;

  bool IsWith(const TriangleEdge& other) const { return low == other.low && high == other.high; }
};

// For each triangle the first one that has the same corners, whichever way they are turned: itself
// but where a triangle is drawn again, as for both sides of a sheet.
std::vector<std::size_t> FirstDrawn(const Eigen::Matrix3Xi& triangles) {
  std::vector<std::pair<std::array<int, 3>, std::size_t>> by_corners;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    std::array corners = {triangles(0, t), triangles(1, t), triangles(2, t)};
    std::sort(corners.begin(), corners.end());
    by_corners.emplace_back(corners, static_cast<std::size_t>(t));
  }
  std::sort(by_corners.begin(), by_corners.end());
  std::vector<std::size_t> first(by_corners.size());
  for (std::size_t i = 0; i < by_corners.size(); ++i) {
    const bool is_again = i > 0 && by_corners[i].first == by_corners[i - 1].first;
    first[by_corners[i].second] = is_again ? first[by_corners[i - 1].second] : by_corners[i].second;
  }
  return first;
}

// The edges of all triangles but those that are drawn again; those of the same corners follow each
// other.
std::vector<TriangleEdge> EdgesOf(const Eigen::Matrix3Xi& triangles,
                                  const std::vector<std::size_t>& first_drawn) {
  std::vector<TriangleEdge> edges;
  edges.reserve(static_cast<std::size_t>(3 * triangles.cols()));
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    if (first_drawn[static_cast<std::size_t>(t)] != static_cast<std::size_t>(t)) continue;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({triangles(k, t), triangles((k + 1) % 3, t)});
      edges.push_back({low, high, static_cast<int>(t)});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const TriangleEdge& a, const TriangleEdge& b) {
    return std::array{a.low, a.high, a.triangle} < std::array{b.low, b.high, b.triangle};
  });
  return edges;
}

// Calls `use` for each run of triangles at one edge.
template <typename Use>
void ForEachEdge(const std::vector<TriangleEdge>& edges, const Use& use) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].IsWith(edges[begin])) ++end;
    use(begin, end);
  }
}

// Which shell each triangle belongs to, by the number of one of the shell's triangles, and which
// shells are closed.
struct Shells {
  std::vector<std::size_t> of;
  std::vector<bool> is_closed;
};

Shells ShellsOf(const Eigen::Matrix3Xi& triangles) {
  const auto count = static_cast<std::size_t>(triangles.cols());
  const std::vector<std::size_t> first_drawn = FirstDrawn(triangles);
  const std::vector<TriangleEdge> edges = EdgesOf(triangles, first_drawn);
  boost::disjoint_sets_with_storage<> sets(count);
  for (std::size_t t = 0; t < count; ++t) sets.make_set(t);
  ForEachEdge(edges, [&](std::size_t begin, std::size_t end) {
    if (end - begin != 2) return;
    sets.union_set(static_cast<std::size_t>(edges[begin].triangle),
                   static_cast<std::size_t>(edges[begin + 1].triangle));
  });
  Shells shells{.of = std::vector<std::size_t>(count), .is_closed = std::vector<bool>(count, true)};
  for (std::size_t t = 0; t < count; ++t) shells.of[t] = sets.find_set(first_drawn[t]);
  std::vector<std::size_t> at_edge;
  ForEachEdge(edges, [&](std::size_t begin, std::size_t end) {
    at_edge.clear();
    for (std::size_t i = begin; i < end; ++i) {
      at_edge.push_back(shells.of[static_cast<std::size_t>(edges[i].triangle)]);
    }
    std::sort(at_edge.begin(), at_edge.end());
    for (auto first = at_edge.begin(); first != at_edge.end();) {
      const auto last = std::upper_bound(first, at_edge.end(), *first);
      if (last - first != 2) shells.is_closed[*first] = false;
      first = last;
    }
  });
  return shells;
}

// The component with one vertex for each place.
SceneComponent Welded(const SceneComponent& component, double tolerance) {
  const Eigen::VectorXi places = WeldPoints(component.vertices, tolerance);
  SceneComponent welded;
  welded.vertices.resize(3, places.size() == 0 ? 0 : places.maxCoeff() + 1);
  for (Eigen::Index i = places.size() - 1; i >= 0; --i) {
    welded.vertices.col(places(i)) = component.vertices.col(i);
  }
  std::vector<int> corners;
  for (const auto& triangle : component.triangles.colwise()) {
    const int a = places(triangle(0)), b = places(triangle(1)), c = places(triangle(2));
    if (a != b && b != c && c != a) corners.insert(corners.end(), {a, b, c});
  }
  welded.triangles = Eigen::Map<const Eigen::Matrix3Xi>(
      corners.data(), 3, static_cast<Eigen::Index>(corners.size() / 3));
  return welded;
}

// The closed shells of a connected surface, and what is left of it, each connected, with the number
// of its first triangle.
std::vector<std::pair<int, SurfacePiece>> ShellsAndRest(const SceneComponent& connected) {
  const Shells shells = ShellsOf(connected.triangles);
  std::vector<std::vector<int>> of_shell(shells.of.size());
  std::vector<int> rest;
  for (std::size_t t = 0; t < shells.of.size(); ++t) {
    const std::size_t shell = shells.of[t];
    (shells.is_closed[shell] ? of_shell[shell] : rest).push_back(static_cast<int>(t));
  }
  std::vector<std::pair<int, SurfacePiece>> pieces;
  const auto add = [&](const std::vector<int>& triangles, bool is_closed) {
    if (triangles.empty()) return;
    for (SceneComponent& piece : Separated(PieceOf(connected, triangles))) {
      pieces.push_back({triangles.front(),
                        {0, {std::move(piece.vertices), std::move(piece.triangles)}, is_closed}});
    }
  };
  for (const std::vector<int>& triangles : of_shell) add(triangles, true);
  add(rest, false);
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return pieces;
}

}  // namespace

std::vector<SurfacePiece> PiecesOf(const Scene& scene) {
  const Eigen::AlignedBox3d box = BoxOf(scene);
  const double tolerance = box.isEmpty() ? 0 : kSameCorner * box.diagonal().norm();
  std::vector<SurfacePiece> pieces;
  for (std::size_t c = 0; c < scene.components.size(); ++c) {
    const SceneComponent welded = Welded(scene.components[c], tolerance);
    for (const SceneComponent& connected : Separated(welded)) {
      for (auto& [first, piece] : ShellsAndRest(connected)) {
        piece.component = static_cast<int>(c);
        pieces.push_back(std::move(piece));
      }
    }
  }
  return pieces;
}

Eigen::AlignedBox3d BoxOf(const SurfaceMesh& surface) {
  return {surface.vertices.rowwise().minCoeff(), surface.vertices.rowwise().maxCoeff()};
}

}  // namespace mortise::mesh
