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
// derivative is by the offset.
struct SplineValue {
  double value = 0;
  double slope = 0;
};

inline SplineValue LinearSpline(double offset) {
  const double distance = offset < 0 ? -offset : offset;
  if (distance >= 1) return {};
  return {1 - distance, offset < 0 ? 1.0 : -1.0};
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

}  // namespace mortise::maps
