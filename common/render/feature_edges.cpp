#include "common/render/feature_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace mortise::render {
namespace {

struct HalfEdge {
  int low;
  int high;
  int triangle;
};

}  // namespace

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

Eigen::Matrix3Xd TriangleNormals(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles) {
  Eigen::Matrix3Xd normals(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = vertices.col(triangles(0, t));
    const Eigen::Vector3d b = vertices.col(triangles(1, t));
    const Eigen::Vector3d c = vertices.col(triangles(2, t));
    normals.col(t) = (b - a).cross(c - a).stableNormalized();
  }
  return normals;
}

std::vector<FeatureEdge> FindFeatureEdges(
    const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles, double feature_angle,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& faces_eye) {
  const std::vector<int> merged = MergeVertices(vertices);
  const Eigen::Matrix3Xd normals = TriangleNormals(vertices, triangles);
  std::vector<bool> front(triangles.cols());
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.cols());
  for (int t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d centre = (vertices.col(triangles(0, t)) + vertices.col(triangles(1, t)) +
                                    vertices.col(triangles(2, t))) /
                                   3;
    front[t] = faces_eye(centre, normals.col(t));
    for (int k = 0; k < 3; ++k) {
      const int a = merged[triangles(k, t)];
      const int b = merged[triangles((k + 1) % 3, t)];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), t});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::array{a.low, a.high, a.triangle} < std::array{b.low, b.high, b.triangle};
  });
  const double cosine = std::cos(feature_angle);
  std::vector<FeatureEdge> features;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t next = i + 1;
    while (next < edges.size() && edges[next].low == edges[i].low &&
           edges[next].high == edges[i].high) {
      ++next;
    }
    bool drawn = next - i != 2;
    if (!drawn) {
      const int a = edges[i].triangle, b = edges[i + 1].triangle;
      drawn = front[a] != front[b] || normals.col(a).dot(normals.col(b)) < cosine;
    }
    if (drawn) features.push_back({vertices.col(edges[i].low), vertices.col(edges[i].high)});
    i = next;
  }
  return features;
}

}  // namespace mortise::render
