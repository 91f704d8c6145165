// Small-polygon geometry: quadratic algorithms, right for outlines of parts.
#include "common/design/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mortise::parametric {
namespace {

using Eigen::Matrix2Xd;
using Eigen::Vector2d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Twice the signed area of the triangle a b c.
double Turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) { return Cross(b - a, c - a); }

double DistanceToSegment(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - a - t * along).norm();
}

bool SegmentsMeet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d,
                  double tolerance) {
  const double c_side = Turn(a, b, c), d_side = Turn(a, b, d);
  const double a_side = Turn(c, d, a), b_side = Turn(c, d, b);
  if (((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0))) return true;
  return DistanceToSegment(c, a, b) < tolerance || DistanceToSegment(d, a, b) < tolerance ||
         DistanceToSegment(a, c, d) < tolerance || DistanceToSegment(b, c, d) < tolerance;
}

bool InTriangle(const Vector2d& point, const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return Turn(a, b, point) >= 0 && Turn(b, c, point) >= 0 && Turn(c, a, point) >= 0;
}

// The part of `polygon` on the left of the line a → b (Sutherland–Hodgman).
Matrix2Xd ClipLeft(const Matrix2Xd& polygon, const Vector2d& a, const Vector2d& b) {
  std::vector<Vector2d> kept;
  const Eigen::Index count = polygon.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector2d from = polygon.col(i), to = polygon.col((i + 1) % count);
    const double from_side = Turn(a, b, from), to_side = Turn(a, b, to);
    if (from_side >= 0) kept.push_back(from);
    if ((from_side > 0 && to_side < 0) || (from_side < 0 && to_side > 0)) {
      kept.push_back(from + (to - from) * (from_side / (from_side - to_side)));
    }
  }
  Matrix2Xd result(2, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = kept[i];
  return result;
}

}  // namespace

double SignedArea(const Matrix2Xd& polygon) {
  double twice = 0;
  for (Eigen::Index i = 0; i < polygon.cols(); ++i) {
    twice += Cross(polygon.col(i), polygon.col((i + 1) % polygon.cols()));
  }
  return twice / 2;
}

bool IsSimple(const Matrix2Xd& polygon, double tolerance) {
  const Eigen::Index count = polygon.cols();
  if (count < 3) return false;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector2d a = polygon.col(i), b = polygon.col((i + 1) % count);
    const Vector2d next = polygon.col((i + 2) % count);
    if ((b - a).norm() < tolerance) return false;
    // A neighbour may only touch at the common corner.
    if (DistanceToSegment(next, a, b) < tolerance || DistanceToSegment(a, b, next) < tolerance) {
      return false;
    }
    for (Eigen::Index j = i + 2; j < count; ++j) {
      if (i == 0 && j == count - 1) continue;
      if (SegmentsMeet(a, b, polygon.col(j), polygon.col((j + 1) % count), tolerance)) return false;
    }
  }
  return true;
}

bool IsConvex(const Matrix2Xd& polygon) {
  const Eigen::Index count = polygon.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    if (Turn(polygon.col(i), polygon.col((i + 1) % count), polygon.col((i + 2) % count)) < 0) {
      return false;
    }
  }
  return true;
}

std::vector<std::array<int, 3>> Triangulate(const Matrix2Xd& polygon) {
  std::vector<int> ring(static_cast<std::size_t>(polygon.cols()));
  std::iota(ring.begin(), ring.end(), 0);
  std::vector<std::array<int, 3>> triangles;
  const auto corner = [&](std::size_t i) -> Vector2d { return polygon.col(ring[i % ring.size()]); };
  while (ring.size() > 3) {
    // The ear whose smallest height is largest keeps slivers away.
    std::size_t best = ring.size();
    double best_quality = -1;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d a = corner(i + ring.size() - 1), b = corner(i), c = corner(i + 1);
      const double turn = Turn(a, b, c);
      if (turn <= 0) continue;
      bool empty = true;
      for (std::size_t j = 0; j + 3 < ring.size() && empty; ++j) {
        empty = !InTriangle(corner(i + 2 + j), a, b, c);
      }
      const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
      if (empty && turn / longest > best_quality) {
        best_quality = turn / longest;
        best = i;
      }
    }
    // A simple polygon always has an ear; rounding may hide it among collinear corners.
    if (best == ring.size()) best = 0;
    const std::size_t size = ring.size();
    triangles.push_back({ring[(best + size - 1) % size], ring[best], ring[(best + 1) % size]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

std::vector<Matrix2Xd> ConvexPieces(const Matrix2Xd& polygon) {
  if (IsConvex(polygon)) return {polygon};
  std::vector<Matrix2Xd> pieces;
  for (const auto& [a, b, c] : Triangulate(polygon)) {
    Matrix2Xd piece(2, 3);
    piece << polygon.col(a), polygon.col(b), polygon.col(c);
    pieces.push_back(piece);
  }
  return pieces;
}

std::vector<Matrix2Xd> Intersect(const Matrix2Xd& a, const Matrix2Xd& b, double tolerance) {
  std::vector<Matrix2Xd> overlaps;
  const std::vector<Matrix2Xd> clippers = ConvexPieces(b);
  for (const Matrix2Xd& piece : ConvexPieces(a)) {
    for (const Matrix2Xd& clipper : clippers) {
      Matrix2Xd overlap = piece;
      for (Eigen::Index i = 0; i < clipper.cols() && overlap.cols() > 0; ++i) {
        overlap = ClipLeft(overlap, clipper.col(i), clipper.col((i + 1) % clipper.cols()));
      }
      if (overlap.cols() < 3) continue;
      const Vector2d extent = overlap.rowwise().maxCoeff() - overlap.rowwise().minCoeff();
      if (SignedArea(overlap) > tolerance * extent.maxCoeff()) overlaps.push_back(overlap);
    }
  }
  return overlaps;
}

bool Contains(const Matrix2Xd& polygon, const Vector2d& point, double tolerance) {
  const Eigen::Index count = polygon.cols();
  bool inside = false;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector2d a = polygon.col(i), b = polygon.col((i + 1) % count);
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double crossing = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (point.x() < crossing) inside = !inside;
  }
  if (inside) return true;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (DistanceToSegment(point, polygon.col(i), polygon.col((i + 1) % count)) <= tolerance) {
      return true;
    }
  }
  return false;
}

}  // namespace mortise::parametric
