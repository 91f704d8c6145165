#include "common/mesh/shapes/countersinks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "common/mesh/shapes/circle.h"
#include "common/mesh/shared_edges.h"

namespace mortise::mesh {
namespace {

constexpr double kLevel = 1e-9;         // 1 less the cosine of a flat face with the axis; of a
                                        // triangle that runs along it, the cosine
constexpr std::size_t kMinCorners = 5;  // of a circle: fewer nearly always lie on one

// The edges between a flat face and what slopes away from it.
struct Rim {
  std::vector<SharedEdge> edges;  // `first` is of the flat face
};

class CountersinkSearch {
 public:
  CountersinkSearch(const DrawnShape& shape, const Eigen::Matrix3Xd& vertices,
                    const Eigen::Matrix3Xd& normals, const std::vector<SharedEdge>& edges, int axis)
      : shape_(shape),
        vertices_(vertices),
        normals_(normals),
        edges_(edges),
        axis_(axis),
        across_{(axis + 1) % 3, (axis + 2) % 3} {}

  std::vector<Countersink> Find() const {
    std::vector<Countersink> found;
    for (const Rim& rim : Rims()) {
      const std::optional<Countersink> countersink = CountersinkAt(rim);
      if (countersink) found.push_back(*countersink);
    }
    return found;
  }

 private:
  bool IsFlat(int t) const { return 1 - std::abs(normals_(axis_, t)) <= kLevel; }
  bool Slopes(int t) const { return !IsFlat(t) && std::abs(normals_(axis_, t)) > kLevel; }
  Eigen::Vector2d Seen(int vertex) const { return vertices_.col(vertex)(across_); }

  // Those that hang together, each by its vertices.
  std::vector<Rim> Rims() const {
    boost::disjoint_sets_with_storage<> sets(static_cast<std::size_t>(vertices_.cols()));
    for (std::size_t v = 0; v < static_cast<std::size_t>(vertices_.cols()); ++v) sets.make_set(v);
    std::vector<SharedEdge> between;
    for (SharedEdge edge : edges_) {
      if (IsFlat(edge.second)) std::swap(edge.first, edge.second);
      if (!IsFlat(edge.first) || !Slopes(edge.second)) continue;
      between.push_back(edge);
      sets.union_set(static_cast<std::size_t>(edge.low), static_cast<std::size_t>(edge.high));
    }
    std::map<std::size_t, Rim> rims;
    for (const SharedEdge& edge : between) {
      rims[sets.find_set(static_cast<std::size_t>(edge.low))].edges.push_back(edge);
    }
    std::vector<Rim> found;
    for (auto& [set, rim] : rims) found.push_back(std::move(rim));
    return found;
  }

  // The vertices of a rim, if it closes on itself once.
  static std::vector<int> VerticesOf(const Rim& rim) {
    std::map<int, int> met;
    for (const SharedEdge& edge : rim.edges) {
      ++met[edge.low];
      ++met[edge.high];
    }
    std::vector<int> vertices;
    for (const auto& [vertex, count] : met) {
      if (count != 2) return {};
      vertices.push_back(vertex);
    }
    return vertices;
  }

  std::optional<Countersink> CountersinkAt(const Rim& rim) const {
    const std::vector<int> corners = VerticesOf(rim);
    if (corners.size() < kMinCorners) return std::nullopt;
    Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(corners.size()));
    for (std::size_t i = 0; i < corners.size(); ++i) {
      points.col(static_cast<Eigen::Index>(i)) = Seen(corners[i]);
    }
    const std::optional<Circle> circle = CircleThrough(points);
    if (!circle || !std::all_of(rim.edges.begin(), rim.edges.end(), [&](const SharedEdge& edge) {
          return LeadsInwards(edge, *circle);
        })) {
      return std::nullopt;
    }
    const auto [low, high] = DepthOf(rim);
    Countersink countersink;
    countersink.axis = axis_;
    countersink.middle[axis_] = (low + high) / 2;
    countersink.middle[across_[0]] = circle->middle.x();
    countersink.middle[across_[1]] = circle->middle.y();
    countersink.radius = circle->radius;
    countersink.depth = high - low;
    return countersink;
  }

  // Whether the flat face lies outside the circle at an edge, and what slopes away inside and
  // below.
  bool LeadsInwards(const SharedEdge& edge, const Circle& circle) const {
    const Eigen::Vector2d middle = (Seen(edge.low) + Seen(edge.high)) / 2;
    const auto opposite = [&](int t) {
      return shape_.triangles.col(t).sum() - edge.low - edge.high;
    };
    const auto outwards = [&](int t) {
      return (Seen(opposite(t)) - middle).dot(middle - circle.middle);
    };
    const double rises = vertices_(axis_, opposite(edge.second)) - vertices_(axis_, edge.low);
    return outwards(edge.first) > 0 && outwards(edge.second) < 0 &&
           rises * normals_(axis_, edge.first) < 0;
  }

  // From where to where what slopes reaches along the axis, m.
  std::pair<double, double> DepthOf(const Rim& rim) const {
    std::set<int> faces;
    for (const SharedEdge& edge : rim.edges) faces.insert(shape_.triangle_face(edge.second));
    const double begin = vertices_(axis_, rim.edges.front().low);
    double low = begin, high = begin;
    for (Eigen::Index t = 0; t < shape_.triangles.cols(); ++t) {
      if (faces.count(shape_.triangle_face(t)) == 0) continue;
      for (int k = 0; k < 3; ++k) {
        const double height = vertices_(axis_, shape_.triangles(k, t));
        low = std::min(low, height);
        high = std::max(high, height);
      }
    }
    return {low, high};
  }

  const DrawnShape& shape_;
  const Eigen::Matrix3Xd& vertices_;  // m
  const Eigen::Matrix3Xd& normals_;   // of the triangles, outward, of length 1
  const std::vector<SharedEdge>& edges_;
  const int axis_;
  const std::array<int, 2> across_;
};

}  // namespace

std::vector<Countersink> CountersinksOf(const DrawnShape& shape) {
  if (!shape.is_solid) return {};
  const Eigen::Matrix3Xd vertices = shape.size.asDiagonal() * shape.fractions;
  const Eigen::Matrix3Xd normals = TriangleNormals(vertices, shape.triangles);
  const std::vector<SharedEdge> edges = SharedEdges(shape.triangles);
  std::vector<Countersink> found;
  for (int axis = 0; axis < 3; ++axis) {
    for (const Countersink& countersink :
         CountersinkSearch(shape, vertices, normals, edges, axis).Find()) {
      found.push_back(countersink);
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Countersink& a, const Countersink& b) {
    return std::tuple(a.axis, a.middle.x(), a.middle.y(), a.middle.z(), a.radius) <
           std::tuple(b.axis, b.middle.x(), b.middle.y(), b.middle.z(), b.radius);
  });
  return found;
}

}  // namespace mortise::mesh
