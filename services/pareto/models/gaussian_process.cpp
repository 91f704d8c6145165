#include "services/pareto/models/gaussian_process.h"

#include <nlopt.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOffsetVariance = 1;  // of b_0, for standardised values
constexpr double kTolerance = 1e-4;    // of the density's logarithm

// A normal prior of a logarithm, within bounds.
struct LogPrior {
  double mean, deviation, least, most;
};

LogPrior LengthPrior(Index D) {
  return {std::log(0.6 * std::sqrt(static_cast<double>(D))), 1.0, std::log(0.02), std::log(100.0)};
}
constexpr LogPrior kSignalPrior{0, 2, -9, 6};
LogPrior SlopePrior(Index D) { return {-std::log(static_cast<double>(D)), 2, -14, 5}; }
constexpr LogPrior kNoisePrior{-14, 4, -18.4, 0};

std::vector<LogPrior> PriorsOf(Index D) {
  std::vector<LogPrior> priors(static_cast<std::size_t>(D), LengthPrior(D));
  priors.push_back(kSignalPrior);
  priors.push_back(SlopePrior(D));
  priors.push_back(kNoisePrior);
  return priors;
}

double MeanOf(const VectorXd& values) { return values.mean(); }

double UnitOf(const VectorXd& values) {
  const double deviation = std::sqrt((values.array() - values.mean()).square().mean());
  return deviation > 1e-12 * values.cwiseAbs().maxCoeff() ? deviation : 1;
}

// The covariance without the noise, in the parts that its derivatives need.
struct Covariance {
  MatrixXd process;  // of g
  MatrixXd slope;    // -2 d process / d (a^2 / 5) = (5/3) s^2 (1 + a) exp(-a)
  MatrixXd linear;   // of b . (u - 1/2)

  MatrixXd Sum() const { return (process + linear).array() + kOffsetVariance; }
};

// The distances a of all points of `a` (columns) from all of `b` (rows, columns).
Eigen::ArrayXXd ScaledDistances(const MatrixXd& a, const MatrixXd& b,
                                const VectorXd& hyperparameters) {
  const VectorXd scale = (-hyperparameters.head(a.rows()).array()).exp();
  const MatrixXd x = scale.asDiagonal() * (a.array() - 0.5).matrix();
  const MatrixXd y = scale.asDiagonal() * (b.array() - 0.5).matrix();
  MatrixXd squares = -2 * x.transpose() * y;
  squares.colwise() += VectorXd(x.colwise().squaredNorm().transpose());
  squares.rowwise() += y.colwise().squaredNorm();
  return (5 * squares.array().max(0.0)).sqrt();
}

Covariance CovarianceOf(const MatrixXd& a, const MatrixXd& b, const VectorXd& hyperparameters) {
  const Index D = a.rows();
  const Eigen::ArrayXXd t = ScaledDistances(a, b, hyperparameters);
  const Eigen::ArrayXXd decay = std::exp(hyperparameters[D]) * (-t).exp();
  Covariance covariance;
  covariance.process = (1 + t + t.square() / 3) * decay;
  covariance.slope = 5.0 / 3 * (1 + t) * decay;
  covariance.linear = std::exp(hyperparameters[D + 1]) * (a.array() - 0.5).matrix().transpose() *
                      (b.array() - 0.5).matrix();
  return covariance;
}

// The sum alone, of many points.
MatrixXd CovarianceSum(const MatrixXd& a, const MatrixXd& b, const VectorXd& hyperparameters) {
  const Index D = a.rows();
  const Eigen::ArrayXXd t = ScaledDistances(a, b, hyperparameters);
  MatrixXd sum =
      (std::exp(hyperparameters[D]) * (1 + t + t.square() / 3) * (-t).exp() + kOffsetVariance)
          .matrix();
  sum.noalias() += std::exp(hyperparameters[D + 1]) * (a.array() - 0.5).matrix().transpose() *
                   (b.array() - 0.5).matrix();
  return sum;
}

// Of the believed function at u itself, its variance before anything is seen.
double PriorVariance(const VectorXd& u, const VectorXd& hyperparameters) {
  const Index D = u.size();
  return std::exp(hyperparameters[D]) + kOffsetVariance +
         std::exp(hyperparameters[D + 1]) * (u.array() - 0.5).square().sum();
}

// Cholesky's factor of `covariance` with as much on its diagonal as it takes.
Eigen::LLT<MatrixXd> Factorize(MatrixXd covariance, double noise) {
  covariance.diagonal().array() += noise;
  Eigen::LLT<MatrixXd> factor(covariance);
  for (double more = noise; factor.info() != Eigen::Success; more *= 10) {
    covariance.diagonal().array() += more;
    factor.compute(covariance);
  }
  return factor;
}

struct Sample {
  const MatrixXd& points;
  VectorXd values;  // standardised
};

Sample Standardized(const MatrixXd& points, const VectorXd& values) {
  return {points, (values.array() - MeanOf(values)) / UnitOf(values)};
}

double LogPosteriorOf(const Sample& sample, const VectorXd& hyperparameters, VectorXd* gradient) {
  const Index D = sample.points.rows(), n = sample.points.cols();
  const double noise = std::exp(hyperparameters[D + 2]);
  const Covariance covariance = CovarianceOf(sample.points, sample.points, hyperparameters);
  const Eigen::LLT<MatrixXd> factor = Factorize(covariance.Sum(), noise);
  const VectorXd weights = factor.solve(sample.values);
  double value =
      -0.5 * sample.values.dot(weights) - factor.matrixLLT().diagonal().array().log().sum();
  const std::vector<LogPrior> priors = PriorsOf(D);
  for (Index i = 0; i < hyperparameters.size(); ++i) {
    const LogPrior& prior = priors[static_cast<std::size_t>(i)];
    value -= 0.5 * std::pow((hyperparameters[i] - prior.mean) / prior.deviation, 2);
  }
  if (gradient == nullptr) return value;
  // d value = tr(W dK) / 2 with W = weights weights^T - K^-1.
  MatrixXd W = -factor.solve(MatrixXd::Identity(n, n));
  W.noalias() += weights * weights.transpose();
  const MatrixXd M = W.cwiseProduct(covariance.slope);
  const VectorXd sums = M.rowwise().sum();
  const MatrixXd product = sample.points * M;
  gradient->resize(D + 3);
  for (Index i = 0; i < D; ++i) {
    const double weighted =
        sample.points.row(i).cwiseAbs2() * sums - product.row(i).dot(sample.points.row(i));
    (*gradient)[i] = weighted * std::exp(-2 * hyperparameters[i]);
  }
  (*gradient)[D] = 0.5 * W.cwiseProduct(covariance.process).sum();
  (*gradient)[D + 1] = 0.5 * W.cwiseProduct(covariance.linear).sum();
  (*gradient)[D + 2] = 0.5 * noise * W.trace();
  for (Index i = 0; i < hyperparameters.size(); ++i) {
    const LogPrior& prior = priors[static_cast<std::size_t>(i)];
    (*gradient)[i] -= (hyperparameters[i] - prior.mean) / std::pow(prior.deviation, 2);
  }
  return value;
}

double Density(unsigned count, const double* hyperparameters, double* gradient, void* data) {
  const auto& sample = *static_cast<const Sample*>(data);
  const VectorXd at = VectorXd::Map(hyperparameters, static_cast<Index>(count));
  VectorXd slope;
  const double value = LogPosteriorOf(sample, at, gradient == nullptr ? nullptr : &slope);
  if (gradient != nullptr) std::ranges::copy(slope, gradient);
  return value;
}

// From `start`; what it is worth is returned as well.
double Improve(Sample& sample, VectorXd& start, int evaluations) {
  const std::vector<LogPrior> priors = PriorsOf(sample.points.rows());
  VectorXd least(start.size()), most(start.size());
  for (Index i = 0; i < start.size(); ++i) {
    least[i] = priors[static_cast<std::size_t>(i)].least;
    most[i] = priors[static_cast<std::size_t>(i)].most;
  }
  start = start.cwiseMax(least).cwiseMin(most).eval();
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)> optimizer(
      nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(start.size())), &nlopt_destroy);
  nlopt_set_max_objective(optimizer.get(), Density, &sample);
  nlopt_set_lower_bounds(optimizer.get(), least.data());
  nlopt_set_upper_bounds(optimizer.get(), most.data());
  nlopt_set_ftol_abs(optimizer.get(), kTolerance);
  nlopt_set_maxeval(optimizer.get(), evaluations);
  VectorXd best = start;
  double value = 0;
  nlopt_optimize(optimizer.get(), best.data(), &value);
  if (best.allFinite()) start = best.cwiseMax(least).cwiseMin(most);
  return LogPosteriorOf(sample, start, nullptr);
}

}  // namespace

GaussianProcess::Hyperparameters GaussianProcess::Fit(const MatrixXd& points,
                                                      const VectorXd& values,
                                                      const Hyperparameters& start,
                                                      int evaluations) {
  const Index D = points.rows();
  Sample sample = Standardized(points, values);
  std::vector<VectorXd> starts;
  if (start.size() == D + 3) {
    starts.push_back(start);
  } else {
    const std::vector<LogPrior> priors = PriorsOf(D);
    VectorXd smooth(D + 3);
    for (Index i = 0; i < smooth.size(); ++i) smooth[i] = priors[static_cast<std::size_t>(i)].mean;
    VectorXd rippled = smooth;
    rippled.head(D).array() -= 1.2;
    rippled[D + 1] -= 4;
    VectorXd noisy = smooth;
    noisy[D + 2] = -4;
    starts = {smooth, rippled, noisy};
  }
  VectorXd best;
  double most = -std::numeric_limits<double>::infinity();
  for (VectorXd& at : starts) {
    const double value = Improve(sample, at, evaluations);
    if (!best.size() || value > most) {
      most = value;
      best = at;
    }
  }
  return best;
}

double GaussianProcess::LogPosterior(const MatrixXd& points, const VectorXd& values,
                                     const Hyperparameters& hyperparameters, VectorXd* gradient) {
  return LogPosteriorOf(Standardized(points, values), hyperparameters, gradient);
}

GaussianProcess::GaussianProcess(const MatrixXd& points, const VectorXd& values,
                                 const Hyperparameters& hyperparameters)
    : hyperparameters_(hyperparameters),
      points_(points),
      offset_(MeanOf(values)),
      unit_(UnitOf(values)),
      values_((values.array() - offset_) / unit_) {
  const Eigen::LLT<MatrixXd> factor =
      Factorize(CovarianceOf(points_, points_, hyperparameters_).Sum(),
                std::exp(hyperparameters_[points_.rows() + 2]));
  factor_ = factor.matrixL();
  weights_ = factor.solve(values_);
}

double GaussianProcess::noise() const {
  return unit_ * std::exp(0.5 * hyperparameters_[points_.rows() + 2]);
}

void GaussianProcess::Add(const VectorXd& u, double value) {
  const Index n = points_.cols();
  const VectorXd covariance = CovarianceOf(points_, u, hyperparameters_).Sum();
  const VectorXd row = factor_.triangularView<Eigen::Lower>().solve(covariance);
  const double noise = std::exp(hyperparameters_[points_.rows() + 2]);
  const double rest = PriorVariance(u, hyperparameters_) + noise - row.squaredNorm();
  factor_.conservativeResize(n + 1, n + 1);
  factor_.col(n).setZero();
  factor_.row(n).head(n) = row.transpose();
  factor_(n, n) = std::sqrt(std::max(rest, 0.5 * noise));
  points_.conservativeResize(Eigen::NoChange, n + 1);
  points_.col(n) = u;
  values_.conservativeResize(n + 1);
  values_[n] = (value - offset_) / unit_;
  weights_ = factor_.triangularView<Eigen::Lower>().solve(values_);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(weights_);
}

GaussianProcess::Prediction GaussianProcess::Predict(const VectorXd& u) const {
  const Index D = points_.rows();
  const Covariance parts = CovarianceOf(points_, u, hyperparameters_);
  const VectorXd covariance = parts.Sum();
  VectorXd solved = factor_.triangularView<Eigen::Lower>().solve(covariance);
  const double prior = PriorVariance(u, hyperparameters_);
  const double variance = std::max(prior - solved.squaredNorm(), 1e-12 * prior);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(solved);
  // D x n: the slope at u of the covariance with each point.
  const double slopes = std::exp(hyperparameters_[D + 1]);
  const VectorXd scale = (-2 * hyperparameters_.head(D).array()).exp();
  MatrixXd gradient =
      (scale.asDiagonal() * (points_.colwise() - u)) * parts.slope.col(0).asDiagonal();
  gradient += slopes * (points_.array() - 0.5).matrix();
  Prediction prediction;
  prediction.mean = offset_ + unit_ * covariance.dot(weights_);
  prediction.deviation = unit_ * std::sqrt(variance);
  prediction.mean_gradient = unit_ * gradient * weights_;
  prediction.deviation_gradient =
      unit_ / std::sqrt(variance) * (slopes * (u.array() - 0.5).matrix() - gradient * solved);
  return prediction;
}

GaussianProcess::Predictions GaussianProcess::PredictAll(const MatrixXd& points) const {
  MatrixXd covariance = CovarianceSum(points_, points, hyperparameters_);
  Predictions predictions;
  predictions.means = (unit_ * covariance.transpose() * weights_).array() + offset_;
  factor_.triangularView<Eigen::Lower>().solveInPlace(covariance);
  predictions.deviations.resize(points.cols());
  for (Index k = 0; k < points.cols(); ++k) {
    const double prior = PriorVariance(points.col(k), hyperparameters_);
    const double variance = std::max(prior - covariance.col(k).squaredNorm(), 1e-12 * prior);
    predictions.deviations[k] = unit_ * std::sqrt(variance);
  }
  return predictions;
}

}  // namespace mortise::pareto
