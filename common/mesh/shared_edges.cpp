#include "common/mesh/shared_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <tuple>
#include <utility>

namespace mortise::mesh {

std::vector<SharedEdge> SharedEdges(const Eigen::Matrix3Xi& triangles) {
  std::vector<std::tuple<int, int, int>> sides;  // low, high, triangle
  sides.reserve(static_cast<std::size_t>(3 * triangles.cols()));
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles(k, t), triangles((k + 1) % 3, t));
      sides.emplace_back(low, high, t);
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<SharedEdge> edges;
  edges.reserve(sides.size() / 2);
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
    const auto [low, high, first] = sides[i];
    edges.push_back({low, high, first, std::get<2>(sides[i + 1])});
  }
  return edges;
}

std::vector<std::vector<int>> ConnectedTriangles(Eigen::Index triangles,
                                                 const std::vector<SharedEdge>& edges,
                                                 absl::FunctionRef<bool(const SharedEdge&)> joins) {
  const auto count = static_cast<std::size_t>(triangles);
  boost::disjoint_sets_with_storage<> sets(count);
  for (std::size_t t = 0; t < count; ++t) sets.make_set(t);
  for (const SharedEdge& edge : edges) {
    if (!joins(edge)) continue;
    sets.union_set(static_cast<std::size_t>(edge.first), static_cast<std::size_t>(edge.second));
  }
  std::vector<std::vector<int>> pieces;
  std::vector<std::size_t> piece_of_set(count, count);
  for (std::size_t t = 0; t < count; ++t) {
    std::size_t& piece = piece_of_set[sets.find_set(t)];
    if (piece == count) {
      piece = pieces.size();
      pieces.emplace_back();
    }
    pieces[piece].push_back(static_cast<int>(t));
  }
  return pieces;
}

Eigen::Matrix3Xd TriangleNormals(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles) {
  Eigen::Matrix3Xd normals(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d corner = vertices.col(triangles(0, t));
    normals.col(t) = (vertices.col(triangles(1, t)) - corner)
                         .cross(vertices.col(triangles(2, t)) - corner)
                         .stableNormalized();
  }
  return normals;
}

double TurnBetween(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  return std::atan2(first.cross(second).norm(), first.dot(second));
}

}  // namespace mortise::mesh
