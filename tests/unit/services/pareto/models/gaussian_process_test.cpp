// Gaussian processes: they go through their data, tell how sure they are, and their slopes are
// those of what they say.
#include "services/pareto/models/gaussian_process.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "common/base/random.h"
#include "services/pareto/archive/stochastic_sampling.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Points(Index count, Index D, std::uint64_t seed) {
  Random random(seed);
  MatrixXd points(D, count);
  Index k = 0;
  for (const VectorXd& u : LatinHypercube(count, D, random)) points.col(k++) = u;
  return points;
}

// Smooth, with a product.
double Smooth(const VectorXd& u) {
  return 3 + 5 * std::sin(3 * u[0]) + 4 * u[1] * u[1] * u[0] - u.sum();
}

VectorXd ValuesAt(const MatrixXd& points, double (*function)(const VectorXd&)) {
  VectorXd values(points.cols());
  for (Index k = 0; k < points.cols(); ++k) values[k] = function(points.col(k));
  return values;
}

GaussianProcess Fitted(const MatrixXd& points, const VectorXd& values) {
  return {points, values, GaussianProcess::Fit(points, values)};
}

// By hand: one parameter, values -1 and 1 (standardised already) at 0.25 and 0.75.
TEST(GaussianProcessTest, IsThePosteriorOfTheBooks) {
  const double length = 0.5, signal = 2, slope = 0.5, noise = 0.01;
  const auto covariance = [&](double u, double v) {
    const double a = std::sqrt(5.0) * std::abs(u - v) / length;
    return signal * (1 + a + a * a / 3) * std::exp(-a) + slope * (u - 0.5) * (v - 0.5) + 1;
  };
  Eigen::Matrix2d K;
  K << covariance(0.25, 0.25) + noise, covariance(0.25, 0.75), covariance(0.75, 0.25),
      covariance(0.75, 0.75) + noise;
  const Eigen::Vector2d y(-1, 1);
  const MatrixXd points = Eigen::RowVector2d(0.25, 0.75);
  const VectorXd hyperparameters = Eigen::Vector4d(length, signal, slope, noise).array().log();
  const GaussianProcess process(points, y, hyperparameters);
  for (const double u : {0.0, 0.25, 0.4, 1.0}) {
    const Eigen::Vector2d k(covariance(u, 0.25), covariance(u, 0.75));
    const GaussianProcess::Prediction prediction = process.Predict(VectorXd::Constant(1, u));
    EXPECT_NEAR(prediction.mean, k.dot(K.inverse() * y), 1e-12);
    EXPECT_NEAR(std::pow(prediction.deviation, 2), covariance(u, u) - k.dot(K.inverse() * k),
                1e-12);
  }
  EXPECT_NEAR(process.noise(), 0.1, 1e-12);
}

TEST(GaussianProcessTest, GoesThroughItsDataAndIsLessSureAwayFromThem) {
  const MatrixXd points = Points(30, 3, 1);
  const GaussianProcess process = Fitted(points, ValuesAt(points, Smooth));
  for (Index k = 0; k < points.cols(); ++k) {
    const auto at = process.Predict(points.col(k));
    EXPECT_NEAR(at.mean, Smooth(points.col(k)), 0.02);
    EXPECT_LT(at.deviation, 0.03);
    const auto beside = process.Predict(points.col(k) + VectorXd::Constant(3, 0.1));
    EXPECT_GT(beside.deviation, at.deviation);
  }
}

TEST(GaussianProcessTest, PredictsAndKnowsHowWell) {
  const MatrixXd points = Points(40, 3, 2), others = Points(200, 3, 3);
  const GaussianProcess process = Fitted(points, ValuesAt(points, Smooth));
  const auto predictions = process.PredictAll(others);
  const VectorXd errors = predictions.means - ValuesAt(others, Smooth);
  EXPECT_LT(std::sqrt(errors.array().square().mean()), 0.1);
  const auto within = (errors.array().abs() < 3 * predictions.deviations.array()).count();
  EXPECT_GT(within, 190);
}

TEST(GaussianProcessTest, GradientsAreThoseOfThePredictions) {
  const MatrixXd points = Points(25, 4, 4);
  const GaussianProcess process = Fitted(points, ValuesAt(points, Smooth));
  const VectorXd u = VectorXd::LinSpaced(4, 0.15, 0.8);
  const auto prediction = process.Predict(u);
  const double step = 1e-5;
  for (Index i = 0; i < 4; ++i) {
    const VectorXd move = step * VectorXd::Unit(4, i);
    const auto above = process.Predict(u + move), below = process.Predict(u - move);
    EXPECT_NEAR(prediction.mean_gradient[i], (above.mean - below.mean) / (2 * step), 1e-4);
    EXPECT_NEAR(prediction.deviation_gradient[i], (above.deviation - below.deviation) / (2 * step),
                1e-4);
  }
}

TEST(GaussianProcessTest, GradientOfThePosteriorDensityIsItsSlope) {
  const MatrixXd points = Points(20, 3, 5);
  const VectorXd values = ValuesAt(points, Smooth);
  VectorXd at(6);
  at << -0.5, 0.1, 0.9, 0.4, -1, -6;
  VectorXd gradient;
  GaussianProcess::LogPosterior(points, values, at, &gradient);
  const double step = 1e-5;
  for (Index i = 0; i < at.size(); ++i) {
    const VectorXd move = step * VectorXd::Unit(at.size(), i);
    const double slope = (GaussianProcess::LogPosterior(points, values, at + move) -
                          GaussianProcess::LogPosterior(points, values, at - move)) /
                         (2 * step);
    EXPECT_NEAR(gradient[i], slope, 1e-4 * (1 + std::abs(slope)));
  }
}

TEST(GaussianProcessTest, AddingAValueIsTheSameAsStartingWithIt) {
  const MatrixXd points = Points(20, 3, 6);
  VectorXd values = ValuesAt(points, Smooth);
  // So that both standardise alike.
  values.array() -= values.head(19).mean();
  values[19] = 0;
  values /= std::sqrt(values.head(19).squaredNorm() / 19);
  const VectorXd hyperparameters = GaussianProcess::Fit(points, values);
  GaussianProcess grown(points.leftCols(19), values.head(19), hyperparameters);
  const GaussianProcess whole(points.leftCols(20), values, hyperparameters);
  grown.Add(points.col(19), values[19]);
  ASSERT_EQ(grown.size(), 20);
  const VectorXd u = VectorXd::Constant(3, 0.3);
  EXPECT_NEAR(grown.Predict(u).mean, values[19] + grown.Predict(u).mean - values[19], 1e-12);
  EXPECT_NEAR(grown.Predict(points.col(19)).mean, values[19], 0.01);
  // A unit of sqrt(19 / 20) makes the only difference.
  EXPECT_NEAR(grown.Predict(u).mean, whole.Predict(u).mean, 0.01);
  EXPECT_NEAR(grown.Predict(u).deviation, whole.Predict(u).deviation / std::sqrt(19.0 / 20), 1e-6);
}

TEST(GaussianProcessTest, CopesWithTheSamePointTwiceConstantValuesAndOnePoint) {
  MatrixXd points = Points(12, 2, 7);
  points.col(1) = points.col(0);
  points.col(2) = points.col(0) + VectorXd::Constant(2, 1e-12);
  VectorXd values = ValuesAt(points, [](const VectorXd& u) { return u[0] - u[1]; });
  values[1] += 0.01;
  const auto prediction = Fitted(points, values).Predict(points.col(0));
  EXPECT_NEAR(prediction.mean, values[0], 0.02);
  EXPECT_TRUE(prediction.mean_gradient.allFinite() && prediction.deviation_gradient.allFinite());

  const auto constant = Fitted(points, VectorXd::Constant(12, 1e9)).Predict(points.col(5));
  EXPECT_NEAR(constant.mean, 1e9, 1);
  EXPECT_TRUE(std::isfinite(constant.deviation));

  const auto single =
      Fitted(points.leftCols(1), VectorXd::Constant(1, 7)).Predict(VectorXd::Constant(2, 0.9));
  EXPECT_NEAR(single.mean, 7, 1e-6);
  EXPECT_GT(single.deviation, 0);
}

// Few points in many dimensions: a straight line is found, and no ripple is made up.
TEST(GaussianProcessTest, DoesNotOverfitFewPointsInManyDimensions) {
  const MatrixXd points = Points(15, 20, 8), others = Points(50, 20, 9);
  const auto line = [](const VectorXd& u) { return u.head(3).sum(); };
  const GaussianProcess process = Fitted(points, ValuesAt(points, line));
  const auto predictions = process.PredictAll(others);
  const VectorXd truth = ValuesAt(others, line);
  const double error = (predictions.means - truth).norm();
  const double spread = (truth.array() - truth.mean()).matrix().norm();
  EXPECT_LT(error, spread);
  const auto within =
      ((predictions.means - truth).array().abs() < 2.5 * predictions.deviations.array()).count();
  EXPECT_GT(within, 45);
}

TEST(GaussianProcessTest, SeesNoiseAsNoise) {
  Random random(10);
  const MatrixXd points = Points(120, 2, 11);
  VectorXd values = ValuesAt(points, [](const VectorXd& u) { return std::sin(3 * u[0]) + u[1]; });
  for (double& value : values) value += 0.1 * random.UnitVector(1)[0];  // +-0.1
  const GaussianProcess process = Fitted(points, values);
  EXPECT_GT(process.noise(), 0.05);
  EXPECT_LT(process.noise(), 0.2);
}

}  // namespace
}  // namespace mortise::pareto
