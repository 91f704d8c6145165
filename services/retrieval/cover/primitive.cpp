// Distances from points and from bounded tangent spaces.
#include "services/retrieval/cover/primitive.h"

#include <algorithm>
#include <cmath>

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

// How much of the place `along` (m, in the axes) lies within the ellipsoid: 1 where all of it does.
double PartWithin(const Primitive& primitive, const VectorXd& along) {
  const double scaled = along.cwiseQuotient(primitive.radii).norm();
  return scaled <= 1 ? 1 : 1 / scaled;
}

}  // namespace

double LargestRadius(const Primitive& primitive) {
  return primitive.radii.size() == 0 ? 0 : primitive.radii.maxCoeff();
}

double Distance(const Primitive& primitive, const VectorXd& x) {
  const VectorXd offset = x - primitive.center;
  if (primitive.axes.cols() == 0) return offset.norm();
  const VectorXd along = primitive.axes.transpose() * offset;
  const double beside = std::max(0.0, offset.squaredNorm() - along.squaredNorm());
  const double beyond = 1 - PartWithin(primitive, along);
  return std::sqrt(beside + beyond * beyond * along.squaredNorm());
}

VectorXd PlaceNear(const Primitive& primitive, const VectorXd& x) {
  if (primitive.axes.cols() == 0) return primitive.center;
  const VectorXd along = primitive.axes.transpose() * (x - primitive.center);
  return primitive.center + primitive.axes * (PartWithin(primitive, along) * along);
}

double DistanceBound(const Primitive& primitive, const VectorXd& x) {
  return std::max(0.0, (x - primitive.center).norm() - LargestRadius(primitive));
}

}  // namespace mortise::retrieval
