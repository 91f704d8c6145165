#include "common/render/feature_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/shared_edges.h"

namespace mortise::render {

std::vector<int> MergeVertices(const Eigen::Matrix3Xd& vertices) {
  const int count = static_cast<int>(vertices.cols());
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    return std::array<double, 3>{vertices(0, i), vertices(1, i), vertices(2, i)};
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<int> representative(count);
  for (int i = 0; i < count; ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    representative[order[i]] = same ? representative[order[i - 1]] : order[i];
  }
  return representative;
}

std::vector<FeatureEdge> FindFeatureEdges(
    const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles, double feature_angle,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& faces_eye) {
  const std::vector<int> merged = MergeVertices(vertices);
  const mesh::CutSurface surface(vertices, triangles.unaryExpr([&](int v) { return merged[v]; }));
  const Eigen::Matrix3Xd normals = mesh::TriangleNormals(vertices, triangles);
  std::vector<bool> front(triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d centre = (vertices.col(triangles(0, t)) + vertices.col(triangles(1, t)) +
                                    vertices.col(triangles(2, t))) /
                                   3;
    front[t] = faces_eye(centre, normals.col(t));
  }
  constexpr double kMoreThanAnyCosine = 2;
  const double cosine = feature_angle < 0 ? kMoreThanAnyCosine : std::cos(feature_angle);
  std::vector<FeatureEdge> features;
  for (const mesh::SurfaceEdge& edge : surface.edges()) {
    if (edge.low == edge.high) continue;
    bool drawn = edge.triangles() != 2;
    if (!drawn) {
      const int a = surface.TriangleAt(edge, 0), b = surface.TriangleAt(edge, 1);
      drawn = front[a] != front[b] || normals.col(a).dot(normals.col(b)) < cosine;
    }
    if (drawn) features.push_back({vertices.col(edge.low), vertices.col(edge.high)});
  }
  return features;
}

}  // namespace mortise::render
