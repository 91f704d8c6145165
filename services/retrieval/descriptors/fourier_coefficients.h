// The outline of a silhouette as its distance from a centre, by Fourier coefficients.
#pragma once

#include <Eigen/Core>

#include "services/retrieval/descriptors/silhouette.h"

namespace mortise::retrieval {

// With r(θ) how much of the ray from the origin in direction θ a silhouette covers, and means over
// all directions,
//
//   mean of r,   √2 mean of r cos kθ,   √2 mean of r sin kθ,   k = 1 … order:
//
// the coefficients of r by functions that are orthonormal for that mean. Where each ray leaves the
// silhouette once, r is the distance of the outline from the origin, the function that Zhang and Lu
// (2002) and Chen et al. (2003) transform. They walk along one outer contour; where that starts to
// enclose a hole or falls into two, as silhouettes of families do, the walk jumps to another curve,
// and r does not: its coefficients are integrals over the silhouette, of exp(ikθ) / |p|.
//
// Over a row the integral is exact by the row's ends: dx / |p| is -dθ / sin θ there, and the
// integrals of cos kθ / sin θ and sin kθ / sin θ follow each other by a recurrence.
class FourierCoefficients {
 public:
  explicit FourierCoefficients(int order) : order_(order) {}

  // Returns how many there are: 2 order + 1.
  Eigen::Index size() const { return 2 * order_ + 1; }

  // Returns those of a silhouette of which no row's middle passes through the origin, by k, cosine
  // before sine. The silhouette lies turned by `turn` (rad, counter-clockwise), and the
  // coefficients are those before it was turned.
  Eigen::VectorXd Of(const Silhouette& silhouette, double turn) const;

  // 1 for each coefficient that stays, -1 for each that changes its sign if x does.
  Eigen::VectorXd MirrorSigns() const;

 private:
  int order_;
};

}  // namespace mortise::retrieval
