#include "services/pareto/sources/evolution_strategy.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMinSquare = 1e-20;      // of a sample, over that of a usual one
constexpr double kMinEigenvalue = 1e-14;  // of C, over the largest

// Into [0, 1], mirrored at the bounds.
double Mirrored(double u) {
  const double folded = std::fmod(std::abs(u), 2.0);
  return folded > 1 ? 2 - folded : folded;
}

// How many equal weights would average as much.
double EffectiveCount(const VectorXd& weights) {
  const double sum = weights.sum();
  return sum * sum / weights.squaredNorm();
}

}  // namespace

EvolutionStrategy::EvolutionStrategy(const VectorXd& mean, double size) : mean_(mean), size_(size) {
  const auto n = static_cast<double>(mean.size());
  const int lambda = 4 + static_cast<int>(3 * std::log(n)), mu = lambda / 2;
  weights_.resize(lambda);
  for (int i = 0; i < lambda; ++i) weights_[i] = std::log((lambda + 1) / 2.0) - std::log(i + 1.0);
  effective_ = EffectiveCount(weights_.head(mu));
  path_rate_ = (4 + effective_ / n) / (n + 4 + 2 * effective_ / n);
  size_rate_ = (effective_ + 2) / (n + effective_ + 5);
  size_damping_ = 1 + 2 * std::max(0.0, std::sqrt((effective_ - 1) / (n + 1)) - 1) + size_rate_;
  rank_one_rate_ = 2 / ((n + 1.3) * (n + 1.3) + effective_);
  rank_mu_rate_ = std::min(
      1 - rank_one_rate_, 2 * (effective_ - 2 + 1 / effective_) / ((n + 2) * (n + 2) + effective_));
  weights_.head(mu) /= weights_.head(mu).sum();
  const double worse = EffectiveCount(weights_.tail(lambda - mu));
  const double most =
      std::min({1 + rank_one_rate_ / rank_mu_rate_, 1 + 2 * worse / (effective_ + 2),
                (1 - rank_one_rate_ - rank_mu_rate_) / (n * rank_mu_rate_)});
  weights_.tail(lambda - mu) *= most / weights_.tail(lambda - mu).cwiseAbs().sum();
  expected_length_ = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));
  covariance_ = MatrixXd::Identity(mean.size(), mean.size());
  axes_ = covariance_;
  axis_lengths_ = VectorXd::Ones(mean.size());
  path_ = size_path_ = VectorXd::Zero(mean.size());
}

VectorXd EvolutionStrategy::Sample(Random& random) const {
  VectorXd z(mean_.size());
  for (double& value : z) value = random.Normal();
  return (mean_ + size_ * axes_ * axis_lengths_.cwiseProduct(z)).unaryExpr(&Mirrored);
}

void EvolutionStrategy::Learn(const std::vector<VectorXd>& ranked) {
  const auto n = static_cast<double>(mean_.size());
  const VectorXd scale = axis_lengths_.cwiseInverse();
  MatrixXd steps(mean_.size(), static_cast<Index>(ranked.size()));
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    steps.col(static_cast<Index>(i)) = (ranked[i] - mean_) / size_;
  }
  VectorXd step = VectorXd::Zero(mean_.size());
  for (Index i = 0; i < steps.cols(); ++i) {
    if (weights_[i] > 0) step += weights_[i] * steps.col(i);
  }
  mean_ += size_ * step;
  ++generations_;

  const VectorXd whitened = axes_ * scale.cwiseProduct(axes_.transpose() * step);
  size_path_ = (1 - size_rate_) * size_path_ +
               std::sqrt(size_rate_ * (2 - size_rate_) * effective_) * whitened;
  const double length = size_path_.norm();
  const double settled = std::sqrt(1 - std::pow(1 - size_rate_, 2 * generations_));
  const bool steady = length / settled < (1.4 + 2 / (n + 1)) * expected_length_;
  path_ *= 1 - path_rate_;
  if (steady) path_ += std::sqrt(path_rate_ * (2 - path_rate_) * effective_) * step;

  VectorXd weights = weights_;
  for (Index i = 0; i < steps.cols(); ++i) {
    if (weights[i] >= 0) continue;
    // A sample on the mean, where values can only be set in steps, tells nothing.
    const double square = scale.cwiseProduct(axes_.transpose() * steps.col(i)).squaredNorm();
    weights[i] = square > kMinSquare ? weights[i] * n / square : 0;
  }
  const double lost = steady ? 0 : path_rate_ * (2 - path_rate_);
  covariance_ *= 1 + rank_one_rate_ * lost - rank_one_rate_ - rank_mu_rate_ * weights_.sum();
  covariance_ += rank_one_rate_ * path_ * path_.transpose() +
                 rank_mu_rate_ * steps * weights.asDiagonal() * steps.transpose();
  size_ *= std::exp(std::min(1.0, size_rate_ / size_damping_ * (length / expected_length_ - 1)));
  if (generations_ - decomposed_ > 1 / (10 * n * (rank_one_rate_ + rank_mu_rate_))) Decompose();
}

void EvolutionStrategy::Decompose() {
  decomposed_ = generations_;
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(covariance_);
  axes_ = eigen.eigenvectors();
  const double most = eigen.eigenvalues().maxCoeff();
  axis_lengths_ = eigen.eigenvalues().cwiseMax(kMinEigenvalue * most).cwiseSqrt();
}

void EvolutionStrategy::Restart(const VectorXd& mean, double size) {
  Decompose();
  mean_ = mean;
  size_ = size / axis_lengths_.maxCoeff();
  path_ = size_path_ = VectorXd::Zero(mean.size());
  generations_ = decomposed_ = 0;
}

}  // namespace mortise::pareto
