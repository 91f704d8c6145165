// The B-splines of which a map's basis functions are sums (thesis 6.4.1 and 6.5.3).
#pragma once

namespace mortise::maps {

enum class Basis {
  kLinear,  // continuous; a sample acts on the elements that it touches
  kCubic,   // twice continuously differentiable; a sample acts on a wider neighbourhood
};

// Half of the support of a B-spline, in distances of its level's centres.
inline int ReachOf(Basis basis) { return basis == Basis::kLinear ? 1 : 2; }

// A B-spline along one direction, and its derivative, at `offset` distances from its centre. The
// derivative is by the offset; where it jumps, that of the upper side, so that the derivatives of
// all B-splines at a point are of one side.
struct SplineValue {
  double value = 0;
  double slope = 0;
};

inline SplineValue LinearSpline(double offset) {
  if (offset < -1 || offset >= 1) return {};
  if (offset < 0) return {1 + offset, 1.0};
  return {1 - offset, -1.0};
}

inline SplineValue CubicSpline(double offset) {
  const double distance = offset < 0 ? -offset : offset;
  const double sign = offset < 0 ? -1 : 1;
  if (distance >= 2) return {};
  if (distance >= 1) {
    const double rest = 2 - distance;
    return {rest * rest * rest / 6, -sign * rest * rest / 2};
  }
  return {2.0 / 3 - distance * distance * (1 - distance / 2),
          sign * distance * (1.5 * distance - 2)};
}

inline SplineValue SplineAt(Basis basis, double offset) {
  return basis == Basis::kLinear ? LinearSpline(offset) : CubicSpline(offset);
}

// The same with the derivative of the lower side: for the upper end of the box, which has no other.
inline SplineValue SplineAtEnd(Basis basis, double offset) {
  return {SplineAt(basis, offset).value, -SplineAt(basis, -offset).slope};
}

}  // namespace mortise::maps
