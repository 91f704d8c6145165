// What a manifold in descriptor space is covered with: points, and pieces of tangent spaces that an
// ellipsoid bounds (thesis 4.1).
#pragma once

#include <Eigen/Core>

namespace mortise::retrieval {

// A primitive of a cover. All lengths are distances between descriptors, which have no unit.
struct Primitive {
  Eigen::VectorXd parameters;  // K: the point q of the manifold's parameters at the centre
  Eigen::VectorXd center;      // N: the descriptor M(q)
  Eigen::MatrixXd axes;        // N × m, orthonormal, in the tangent space at q; no column: a point
  Eigen::VectorXd radii;       // m, of the ellipsoid along each axis; all > 0
  int structure = 0;           // the structure of the designs that it stands for
};

// Returns the numbers that are stored for a primitive, in units of a point's: 1 + m (thesis §4.4).
inline int Cost(const Primitive& primitive) { return 1 + static_cast<int>(primitive.axes.cols()); }

// Returns the largest radius; 0 for a point.
double LargestRadius(const Primitive& primitive);

// Returns the distance of descriptor `x` (N) from a primitive (thesis §4.5, Figure 4-6): from a
// point as it is; from a tangent by projection onto its space, and from there to the place on the
// ellipsoid that lies on the same ray in the ellipsoid's own scale. That place is on the primitive,
// so the result is never less than the distance to the nearest place, and equals it where x
// projects into the ellipsoid or the ellipsoid is a sphere. O(N m).
double Distance(const Primitive& primitive, const Eigen::VectorXd& x);

// Returns the place on the primitive (N) that Distance measures to.
Eigen::VectorXd PlaceNear(const Primitive& primitive, const Eigen::VectorXd& x);

// Never more than Distance: the distance from the centre less the largest radius. O(N).
double DistanceBound(const Primitive& primitive, const Eigen::VectorXd& x);

}  // namespace mortise::retrieval
