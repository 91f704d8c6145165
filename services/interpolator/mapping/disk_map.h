// Flattens a patch of a surface into a convex region of the plane, one to one.
//
// Each inner vertex becomes the weighted mean of its neighbours with Floater's mean-value weights
// (Mean value coordinates, CAGD 2003; thesis §6.6.2),
//
//   w_ij = (tan(α/2) + tan(β/2)) / |p_j − p_i|,
//
// α and β being the angles at p_i in the triangles on both sides of the edge. All weights are
// positive, so with a boundary that is strictly convex no triangle is turned over (Tutte, Floater).
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::interpolator {

// A triangulated disk. A vertex of a surface that is on its boundary more than once, as on a slit,
// is as many vertices here.
struct DiskPatch {
  Eigen::Matrix3Xd vertices;   // 3 × V, m
  Eigen::Matrix3Xi triangles;  // 3 × T, counter-clockwise seen from outside
  std::vector<int> boundary;   // vertices, counter-clockwise: the patch lies on their left
};

// A place in a triangulation.
struct TrianglePlace {
  int triangle = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  // not negative, of sum 1
};

// Returns the mean value weights that the triangle between a vertex and two of its neighbours adds
// to the edges from the vertex: to the next one, counter-clockwise, and to the last.
std::pair<double, double> MeanValueWeights(const Eigen::Vector3d& at, const Eigen::Vector3d& next,
                                           const Eigen::Vector3d& last);

class DiskMap {
 public:
  // `boundary`: 2 × number of boundary vertices, where these go, counter-clockwise on a strictly
  // convex curve. INVALID_ARGUMENT naming "patch" if it is no disk with this boundary or has an
  // edge without length, "boundary" if the positions are not as many. INTERNAL where rounding turns
  // triangles over, with equal weights too, which are tried then; RESOURCE_EXHAUSTED where there is
  // too little memory.
  static absl::StatusOr<DiskMap> Create(const DiskPatch& patch, const Eigen::Matrix2Xd& boundary);

  // Returns where each vertex is in the plane, 2 × V.
  const Eigen::Matrix2Xd& positions() const { return positions_; }

  // Returns the triangle that a point of the region is in. A point outside by rounding is taken
  // into the nearest. The search walks from triangle `hint`, which only decides how long it takes.
  TrianglePlace Locate(const Eigen::Vector2d& point, int hint = 0) const;

 private:
  DiskMap(Eigen::Matrix3Xi triangles, Eigen::Matrix2Xd positions);
  static absl::StatusOr<DiskMap> Make(const DiskPatch& patch, const Eigen::Matrix2Xd& boundary);
  Eigen::Vector3d Barycentric(int triangle, const Eigen::Vector2d& point) const;

  Eigen::Matrix3Xi triangles_;
  Eigen::Matrix3Xi neighbours_;  // beyond the side opposite each corner; -1 beyond the boundary
  Eigen::Matrix2Xd positions_;
};

}  // namespace mortise::interpolator
