// Computes the expected hypervolume improvement: how much hypervolume a design is expected to add,
// when its metrics are believed to be independent and normal.
//
// The space that neither the front nor the reference dominates is cut into boxes [l, h] with l =
// -inf allowed. A performance y adds prod_k (h_k - max(l_k, y_k))+ of each, so that
//
//   E = sum over boxes of prod_k (G_k(h_k) - G_k(l_k)),   G_k(b) = E[(b - Y_k)+]
//                                                       = (b - mu) Phi(z) + sigma phi(z),
//
// z = (b - mu) / sigma, exactly (Emmerich, Giannakoglou, Naujoks 2006; Yang, Emmerich, Deutz, Bäck
// 2019). For d = 2 the boxes are the strips below the staircase, for d = 3 they come from sweeping
// the third metric: at most 2 n + 1 boxes.
//
// For d > 3 their number grows as n^(d/2), so the same integral is taken in polar coordinates
// around the reference r: a ray -t lambda, t >= 0, is dominated by the front up to rho(lambda), and
// beyond that by Y with the probability prod_k Phi((r_k - lambda_k t - mu_k) / sigma_k). A fixed
// set of rays, with Gauss's rule on each, gives it within some hundredths, and the same each time.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::pareto {

class ExpectedHypervolumeImprovement {
 public:
  struct Value {
    double expected = 0;                 // hypervolume, >= 0
    Eigen::VectorXd mean_gradient;       // d
    Eigen::VectorXd deviation_gradient;  // d
  };

  // Prepares improvements over what `front` (of d metrics, minimised; dominated points do no harm)
  // dominates below `reference` (d). O(n log n) for d = 2, O(n^2) for d = 3.
  ExpectedHypervolumeImprovement(const std::vector<Eigen::VectorXd>& front,
                                 const Eigen::VectorXd& reference);

  // Return the improvement for metrics of these means and standard deviations (> 0), d each.
  // O(boxes d).
  double Expected(const Eigen::VectorXd& means, const Eigen::VectorXd& deviations) const;
  Value WithGradient(const Eigen::VectorXd& means, const Eigen::VectorXd& deviations) const;

 private:
  void CutPlane(std::vector<Eigen::VectorXd> front);
  void CutSpace(std::vector<Eigen::VectorXd> front);
  void CastRays(const std::vector<Eigen::VectorXd>& front);
  void AddBox(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);
  Value OverBoxes(const Eigen::VectorXd& means, const Eigen::VectorXd& deviations) const;
  Value AlongRays(const Eigen::VectorXd& means, const Eigen::VectorXd& deviations) const;

  Eigen::VectorXd reference_;
  std::vector<Eigen::VectorXd> lower_, upper_;  // boxes, for d <= 3
  std::vector<Eigen::VectorXd> rays_;           // unit vectors > 0, for d > 3
  std::vector<double> dominated_;               // of each ray, rho
};

}  // namespace mortise::pareto
