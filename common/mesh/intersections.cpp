// The search for crossing triangles declared in surface_check.h.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

using Triangle = std::array<Eigen::Vector3d, 3>;

// A triangle with what is asked of it again and again.
struct SweptTriangle {
  Triangle corners;
  Eigen::Array3i vertices;
  Eigen::Vector3d normal;  // m², twice the area long
  double tolerance;        // m³, of heights over its plane times the length of the normal
};

SweptTriangle Prepare(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                      int index) {
  SweptTriangle swept{{}, triangles.col(index), {}, 0};
  for (int k = 0; k < 3; ++k) swept.corners[k] = vertices.col(triangles(k, index));
  const auto& [a, b, c] = swept.corners;
  swept.normal = (b - a).cross(c - a);
  const double length = swept.normal.norm();
  swept.tolerance = 1e-9 * length * std::sqrt(length);
  return swept;
}

int SharedVertices(const SweptTriangle& a, const SweptTriangle& b) {
  const auto in_b = [&b](int vertex) {
    return int{vertex == b.vertices(0)} + int{vertex == b.vertices(1)} +
           int{vertex == b.vertices(2)};
  };
  return in_b(a.vertices(0)) + in_b(a.vertices(1)) + in_b(a.vertices(2));
}

// Where the open segment a–b passes through the triangle, away from the segment's ends and, by
// `slack` (a fraction), from the triangle's border.
std::optional<Eigen::Vector3d> Pierce(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                      const SweptTriangle& triangle, double slack) {
  const Triangle& corners = triangle.corners;
  const Eigen::Vector3d& normal = triangle.normal;
  const Eigen::Vector3d along = b - a;
  const double slope = normal.dot(along);
  if (std::abs(slope) <= 1e-12 * normal.norm() * along.norm()) return std::nullopt;
  const double t = normal.dot(corners[0] - a) / slope;
  if (t <= slack || t >= 1 - slack) return std::nullopt;
  const Eigen::Vector3d u = corners[1] - corners[0], v = corners[2] - corners[0];
  const Eigen::Vector3d point = a + t * along;
  const Eigen::Vector3d offset = point - corners[0];
  const double area2 = normal.squaredNorm();
  const double wv = normal.dot(u.cross(offset)) / area2;
  const double wu = normal.dot(offset.cross(v)) / area2;
  if (wu < -slack || wv < -slack || wu + wv > 1 + slack) return std::nullopt;
  return point;
}

// The smallest overlap of triangles in one plane that counts, in terms of the normal of the first,
// whose length is twice the area.
constexpr double kOverlap = 1e-9;

// Of triangles in one plane: whether an edge of `first` leaves all of `second` outside, but for
// less than a tenth of the overlap that counts.
bool HasDividingEdge(const SweptTriangle& first, const SweptTriangle& second) {
  const double smaller = std::min(first.normal.norm(), second.normal.norm());
  const double tolerance = 0.1 * kOverlap * first.normal.norm() * smaller;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d inward =
        first.normal.cross(first.corners[(k + 1) % 3] - first.corners[k]);
    bool outside = true;
    for (const Eigen::Vector3d& corner : second.corners) {
      outside = outside && inward.dot(corner - first.corners[k]) <= tolerance;
    }
    if (outside) return true;
  }
  return false;
}

// A point common to two triangles in one plane, if they overlap by an area.
std::optional<Eigen::Vector3d> Overlap(const SweptTriangle& swept, const SweptTriangle& other) {
  if (HasDividingEdge(swept, other) || HasDividingEdge(other, swept)) return std::nullopt;
  const Triangle& first = swept.corners;
  const Eigen::Vector3d& normal = swept.normal;
  // Clip the second triangle by the edges of the first; what remains must have an area.
  std::vector<Eigen::Vector3d> polygon(other.corners.begin(), other.corners.end());
  for (int k = 0; k < 3 && !polygon.empty(); ++k) {
    const Eigen::Vector3d inward = normal.cross(first[(k + 1) % 3] - first[k]);
    std::vector<Eigen::Vector3d> clipped;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d& p = polygon[i];
      const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
      const double dp = inward.dot(p - first[k]), dq = inward.dot(q - first[k]);
      if (dp >= 0) clipped.push_back(p);
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) clipped.push_back(p + dp / (dp - dq) * (q - p));
    }
    polygon = clipped;
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    centre += polygon[i] / polygon.size();
    if (i + 1 < polygon.size()) {
      area += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
    }
  }
  if (area.norm() <= kOverlap * normal.norm()) return std::nullopt;
  return centre;
}

// The bounding box of a triangle: along the sweep from `begin` to `end`, and across it as bounds:
// the low and the negative high ends along both other axes.
struct Span {
  double begin, end;
  Eigen::Array4d bounds;
  int triangle;
};

// Whether the boxes lie apart across the sweep: the low end of one is over the high end of the
// other. Subtraction and maximum take no branches, most of which would be mispredicted.
bool AreApart(const Span& a, const Span& b) {
  const Eigen::Array4d high(-a.bounds(2), -a.bounds(3), -a.bounds(0), -a.bounds(1));
  return (b.bounds - high).maxCoeff() > 0;
}

// Boxes by where they begin along the longest axis of all, where fewest are beside each other.
std::vector<Span> SortedSpans(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<std::size_t>(triangles.cols()));
  Eigen::AlignedBox3d all;
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    for (int k = 0; k < 3; ++k) boxes[t].extend(vertices.col(triangles(k, t)));
    all.extend(boxes[t]);
  }
  Eigen::Index first = 0;
  if (!boxes.empty()) all.sizes().maxCoeff(&first);
  const Eigen::Index second = (first + 1) % 3, third = (first + 2) % 3;
  std::vector<Span> spans;
  spans.reserve(boxes.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    const Eigen::Vector3d low = boxes[t].min(), high = boxes[t].max();
    spans.push_back({low(first),
                     high(first),
                     {low(second), low(third), -high(second), -high(third)},
                     static_cast<int>(t)});
  }
  std::sort(spans.begin(), spans.end(),
            [](const Span& a, const Span& b) { return a.begin < b.begin; });
  return spans;
}

// Where the corners of a triangle lie, seen from the plane of another.
enum class Position {
  kAside,   // all that are not shared on one side: the triangles meet in what they share at most
  kInside,  // all in the plane
  kAcross,  // anywhere else
};

Position PositionOf(const Triangle& triangle, const SweptTriangle& other, int shared) {
  int above = 0, below = 0;
  for (const Eigen::Vector3d& corner : triangle) {
    const double height = other.normal.dot(corner - other.corners[0]);
    above += height > other.tolerance;
    below += height < -other.tolerance;
  }
  const bool aside = std::max(above, below) == 3 - shared && std::min(above, below) == 0;
  if (aside && shared < 3) return Position::kAside;
  return above + below == 0 ? Position::kInside : Position::kAcross;
}

std::optional<Eigen::Vector3d> Meet(const SweptTriangle& first, const SweptTriangle& second,
                                    int shared) {
  const Position position = PositionOf(second.corners, first, shared);
  if (position == Position::kAside) return std::nullopt;
  // A triangle without an area has no plane to lie in.
  if (position == Position::kInside && first.tolerance > 0) return Overlap(first, second);
  if (shared >= 2 || PositionOf(first.corners, second, shared) == Position::kAside) {
    return std::nullopt;
  }
  // Neighbours at a vertex touch at the border; strangers may not even touch from within.
  const double slack = shared == 1 ? 1e-9 : 1e-12;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (const auto point = Pierce(first.corners[k], first.corners[next], second, slack)) {
      return point;
    }
    if (const auto point = Pierce(second.corners[k], second.corners[next], first, slack)) {
      return point;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<Intersection> FindIntersections(const Eigen::Matrix3Xd& vertices,
                                            const Eigen::Matrix3Xi& triangles, int limit) {
  const std::vector<Span> spans = SortedSpans(vertices, triangles);
  std::vector<SweptTriangle> swept;
  swept.reserve(spans.size());
  for (const Span& span : spans) swept.push_back(Prepare(vertices, triangles, span.triangle));
  std::vector<Intersection> found;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Span a = spans[i];
    for (std::size_t j = i + 1; j < spans.size() && spans[j].begin <= a.end; ++j) {
      const Span& b = spans[j];
      if (AreApart(a, b)) continue;
      const auto place = Meet(swept[i], swept[j], SharedVertices(swept[i], swept[j]));
      if (!place) continue;
      found.push_back({std::min(a.triangle, b.triangle), std::max(a.triangle, b.triangle), *place});
      if (static_cast<int>(found.size()) >= limit) return found;
    }
  }
  return found;
}

}  // namespace mortise::mesh
