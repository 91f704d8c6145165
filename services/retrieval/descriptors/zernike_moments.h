// Zernike moments of a silhouette.
#pragma once

#include <Eigen/Core>

#include "services/retrieval/descriptors/silhouette.h"

namespace mortise::retrieval {

// Zernike moments (Teague 1980; Khotanzad and Hong 1990) up to an order: with (ρ, θ) the
// coordinates in a disc, R_nm the radial polynomials, 0 ≤ m ≤ n, n - m even, and means over the
// disc,
//
//   √(n+1) mean of R_n0,   √(2n+2) mean of R_nm cos mθ,   √(2n+2) mean of R_nm sin mθ
//
// over the silhouette: its coefficients by functions that are orthonormal for that mean. Hence the
// square of the distance of two silhouettes' moments is the share of the disc that one covers and
// the other does not, but for details finer than the order sees.
//
// A polynomial's integral over a row is exact by its ends, so the moments follow from those of the
// powers x^p y^r, p + r ≤ order, which take a few powers for an end of a span rather than a table
// of 66 functions for each pixel.
class ZernikeMoments {
 public:
  explicit ZernikeMoments(int order);

  // Returns how many there are: (order + 1)(order + 2) / 2.
  Eigen::Index size() const { return by_powers_.rows(); }

  // Returns those of a silhouette in the disc around `centre` of `radius` > 0, by n, then m, cosine
  // before sine. The silhouette lies turned by `turn` (rad, counter-clockwise), and the moments are
  // those before it was turned.
  Eigen::VectorXd Of(const Silhouette& silhouette, const Eigen::Vector2d& centre, double radius,
                     double turn) const;

  // 1 for each moment that stays, -1 for each that changes its sign if x does.
  Eigen::VectorXd MirrorSigns() const;

 private:
  Eigen::VectorXd PowerMoments(const Silhouette& silhouette, const Eigen::Vector2d& centre,
                               double radius) const;

  int order_;
  Eigen::MatrixXd by_powers_;  // moments by the integrals of powers over the unit disc
};

}  // namespace mortise::retrieval
