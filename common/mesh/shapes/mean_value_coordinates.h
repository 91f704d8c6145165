// Computes mean-value coordinates in closed triangle meshes. They make points weighted sums of the
// vertices of a cage, so that whatever moves the cage deforms what is in it (Ju, Schaefer and
// Warren 2005; thesis §7.6.2).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Column k of the result are the coordinates of `points.col(k)`, one a cage vertex, so that
//
//   points = cage.vertices · coordinates        and, for a cage that has been moved,
//   deformed = moved.vertices · coordinates.
//
// The coordinates of a point sum to 1 and reproduce affine maps of the cage up to rounding. They
// are continuous everywhere, and smooth off the cage's triangles. At a vertex of the cage, the
// coordinate of that vertex is 1; on a triangle they are its barycentric coordinates. They are
// defined inside and outside of the cage, convex or not, but may be negative where the cage is not
// convex, and outside of it.
//
// Equation: the weight of vertex i is the sum over its triangles T of the mean of the barycentric
// function b_i over T as seen from the point x,
//   w_i = Σ_T ∫_{Ω_T} b_i(y) / |y - x| dΩ,  found from  Σ_i w_i (p_i - x) = ½ Σ_edges θ_e n_e
// on each triangle (θ_e: angle under which an edge is seen, n_e: normal of its plane with x).
// Coordinates are the weights over their sum.
//
// Where x lies within about 6e-8 (rad, as seen from x) of the plane of a triangle, but beside it,
// that triangle's weights vanish in rounding and are left out; the error is of that order. What
// they miss of partition of unity and linear precision is then put right by the least change of all
// coordinates.
//
// INVALID_ARGUMENT naming "cage" if it is not closed, not oriented outwards, or crosses itself;
// "points[k]" for the first that is not finite. It takes O(points × triangles).
absl::StatusOr<Eigen::MatrixXd> MeanValueCoordinates(const SurfaceMesh& cage,
                                                     const Eigen::Matrix3Xd& points);

}  // namespace mortise::mesh
