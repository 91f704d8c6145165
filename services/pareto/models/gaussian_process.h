// Gaussian-process regression says what a metric is believed to be where it has not been evaluated,
// and how sure that is (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006).
//
// A metric is a linear function plus a Gaussian process, seen through a little noise:
//
//   f(u) = b_0 + b . (u - 1/2) + g(u),    cov(g(u), g(v)) = s^2 (1 + a + a^2 / 3) exp(-a),
//   a^2 = 5 sum_i (u_i - v_i)^2 / l_i^2,
//
// the Matern covariance of smoothness 5/2 with one length l_i a parameter. The coefficients b have
// normal priors themselves (ibid. 2.7), so there may be fewer points than parameters. The lengths,
// s, the variance of the slopes and that of the noise (nugget) maximise the marginal likelihood of
// the values times a prior (ibid. 5.4), which keeps a few points in many dimensions from being
// explained by whatever fits them: lengths of the order of the distances in the box, sqrt(D), and
// hardly any noise, unless the values speak for something else.
//
// Values are standardised before, so that their unit does not matter. Points that are (nearly) the
// same, and values that are all the same, do no harm: the noise has a least value of 1e-8 of the
// values' variance.
#pragma once

#include <Eigen/Core>

namespace mortise::pareto {

class GaussianProcess {
 public:
  // The hyperparameters of standardised values, as natural logarithms: D lengths, then the
  // variances of g (s^2), of the slopes b, and of the noise; D + 3 in all.
  using Hyperparameters = Eigen::VectorXd;

  struct Prediction {
    double mean = 0;
    double deviation = 0;                // of f, without the noise; > 0
    Eigen::VectorXd mean_gradient;       // D
    Eigen::VectorXd deviation_gradient;  // D
  };

  struct Predictions {
    Eigen::VectorXd means;       // k
    Eigen::VectorXd deviations;  // k, without the noise; > 0
  };

  // Returns the hyperparameters of highest posterior density for `values` (n) at `points` (D x n,
  // unit coordinates), n >= 1: a quasi-Newton search (L-BFGS of NLopt, analytic gradients) from
  // `start` or, if there is none, from three: smooth, rippled and noisy. Each takes `evaluations`
  // of the density at most. The same arguments give the same result. O(n^3 + n^2 D) for each
  // evaluation.
  static Hyperparameters Fit(const Eigen::MatrixXd& points, const Eigen::VectorXd& values,
                             const Hyperparameters& start = {}, int evaluations = 60);

  // Returns the logarithm of that density, but for a constant, and its gradient (D + 3) if asked
  // for.
  static double LogPosterior(const Eigen::MatrixXd& points, const Eigen::VectorXd& values,
                             const Hyperparameters& hyperparameters,
                             Eigen::VectorXd* gradient = nullptr);

  // Makes the process given what has been seen of it. O(n^3).
  GaussianProcess(const Eigen::MatrixXd& points, const Eigen::VectorXd& values,
                  const Hyperparameters& hyperparameters);

  // Adds one more value. O(n^2).
  void Add(const Eigen::VectorXd& u, double value);

  // Returns what is believed at `u`. O(n^2 + n D).
  Prediction Predict(const Eigen::VectorXd& u) const;

  // Returns the same for the columns of `points` (D x k), without gradients. O(k (n^2 + n D)).
  Predictions PredictAll(const Eigen::MatrixXd& points) const;

  // Returns the standard deviation of the noise, in the unit of the values.
  double noise() const;

  Eigen::Index size() const { return points_.cols(); }

 private:
  Hyperparameters hyperparameters_;
  Eigen::MatrixXd points_;   // D x n
  double offset_ = 0;        // of the values
  double unit_ = 1;          // of the values: standardised = (value - offset) / unit
  Eigen::VectorXd values_;   // n, standardised
  Eigen::MatrixXd factor_;   // n x n, lower triangular: Cholesky's of the covariance
  Eigen::VectorXd weights_;  // n: covariance^-1 values
};

}  // namespace mortise::pareto
