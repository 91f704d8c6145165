// A Gaussian of designs whose mean, size and shape follow what its samples bring.
//
// It is the evolution strategy with covariance matrix adaptation, in the notation of Hansen's
// tutorial (arXiv 1604.00772; weights below zero for the worse half, §B.3 there): designs u = m +
// sigma y, y ~ N(0, C). It sees nothing but an order of its samples, so that neither kinks nor the
// scale of what is optimised matter to it, and a rotation of the parameters does not either.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/random.h"

namespace mortise::pareto {

class EvolutionStrategy {
 public:
  // Begins at a design in unit coordinates (D), with a standard deviation of `size` in each of
  // them.
  EvolutionStrategy(const Eigen::VectorXd& mean, double size);

  // Returns how many samples a generation has, lambda.
  int samples() const { return static_cast<int>(weights_.size()); }

  // Draws a design within the unit box: a sample outside is mirrored at the bound.
  Eigen::VectorXd Sample(Random& random) const;

  // Learns from the samples of a generation, best first. O(D^2 lambda), and O(D^3) once in some
  // D / 10 generations.
  void Learn(const std::vector<Eigen::VectorXd>& ranked);

  // Goes on from another mean with another size, its shape as learnt.
  void Restart(const Eigen::VectorXd& mean, double size);

  const Eigen::VectorXd& mean() const { return mean_; }

  // Returns the standard deviation along the longest axis, in unit coordinates.
  double Reach() const { return size_ * axis_lengths_.maxCoeff(); }

 private:
  void Decompose();

  Eigen::VectorXd mean_;
  double size_;              // sigma
  Eigen::VectorXd weights_;  // lambda, of the best first; some below zero
  double effective_ = 0;     // mu_eff
  double path_rate_ = 0, size_rate_ = 0, size_damping_ = 0;  // c_c, c_sigma, d_sigma
  double rank_one_rate_ = 0, rank_mu_rate_ = 0;              // c_1, c_mu
  double expected_length_ = 0;                               // of a standard normal vector
  Eigen::MatrixXd covariance_;                               // C
  Eigen::MatrixXd axes_;                                     // B, of C = B D^2 B^T
  Eigen::VectorXd axis_lengths_;                             // D
  Eigen::VectorXd path_, size_path_;                         // p_c, p_sigma
  int generations_ = 0;
  int decomposed_ = 0;  // generation when C was
};

}  // namespace mortise::pareto
