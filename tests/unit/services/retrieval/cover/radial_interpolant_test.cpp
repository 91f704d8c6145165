// What cubic radial basis functions interpolate exactly, and what they say of their errors.
#include "services/retrieval/cover/radial_interpolant.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd ScatteredPoints(Eigen::Index size, Eigen::Index count) {
  Random random(5);
  return MatrixXd::NullaryExpr(size, count, [&] { return random.Uniform(); });
}

MatrixXd ValuesOf(const MatrixXd& points, VectorXd (*function)(const VectorXd&)) {
  MatrixXd values(function(points.col(0)).size(), points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) values.col(i) = function(points.col(i));
  return values;
}

VectorXd Quadratic(const VectorXd& x) {
  return Eigen::Vector2d(1 + x[0] - 3 * x[1] * x[2], x.squaredNorm());
}

VectorXd Waves(const VectorXd& x) {
  return Eigen::Vector2d(std::sin(3 * x[0]) + x[1], std::cos(2 * x[1] * x[0]));
}

TEST(RadialInterpolant, GivesBackWhatItWasGiven) {
  const MatrixXd points = ScatteredPoints(2, 60);
  const MatrixXd values = ValuesOf(points, Waves);
  const auto interpolant = RadialInterpolant::Fit(points, values);
  ASSERT_TRUE(interpolant.ok()) << interpolant.status();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    EXPECT_LT((interpolant->At(points.col(i)) - values.col(i)).norm(), 1e-8);
}

TEST(RadialInterpolant, HasQuadraticFunctionsExactly) {
  const MatrixXd points = ScatteredPoints(3, 40);
  const auto interpolant = RadialInterpolant::Fit(points, ValuesOf(points, Quadratic));
  ASSERT_TRUE(interpolant.ok()) << interpolant.status();
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d x(random.Uniform(), random.Uniform(), random.Uniform());
    EXPECT_LT((interpolant->At(x) - Quadratic(x)).norm(), 1e-8);
  }
  EXPECT_LT(interpolant->left_out_errors().maxCoeff(), 1e-8);
}

TEST(RadialInterpolant, KnowsHowFarItIsOffAtAPointThatItIsNotGiven) {
  const MatrixXd points = ScatteredPoints(2, 50);
  const MatrixXd values = ValuesOf(points, Waves);
  const auto all = RadialInterpolant::Fit(points, values);
  ASSERT_TRUE(all.ok());
  for (const Eigen::Index left_out : {0, 17, 49}) {
    MatrixXd others(2, 49), other_values(2, 49);
    for (Eigen::Index i = 0, next = 0; i < 50; ++i) {
      if (i == left_out) continue;
      others.col(next) = points.col(i);
      other_values.col(next++) = values.col(i);
    }
    const auto without = RadialInterpolant::Fit(others, other_values);
    ASSERT_TRUE(without.ok());
    EXPECT_NEAR(all->left_out_errors()[left_out],
                (without->At(points.col(left_out)) - values.col(left_out)).norm(), 1e-8);
  }
}

// What is smoother is nearer to what lies below noise, and knows it.
TEST(RadialInterpolant, IsSmootherThanNoise) {
  constexpr double kNoise = 0.05;
  const MatrixXd points = ScatteredPoints(2, 200);
  Random random(6);
  const MatrixXd values = ValuesOf(points, Waves) + kNoise * MatrixXd::NullaryExpr(2, 200, [&] {
                                                      return 2 * random.Uniform() - 1;
                                                    });
  const RadialInterpolant met = RadialInterpolant::Fit(points, values).value();
  const RadialInterpolant smooth = RadialInterpolant::Fit(points, values, 1e-2).value();
  double off_met = 0, off_smooth = 0;
  for (int i = 0; i < 100; ++i) {
    const VectorXd x = VectorXd::NullaryExpr(2, [&] { return 0.1 + 0.8 * random.Uniform(); });
    off_met += (met.At(x) - Waves(x)).norm() / 100;
    off_smooth += (smooth.At(x) - Waves(x)).norm() / 100;
  }
  EXPECT_LT(off_smooth, 0.7 * off_met);
  EXPECT_LT(off_smooth, kNoise);
  EXPECT_LT(smooth.left_out_errors().mean(), met.left_out_errors().mean());
}

// The errors are those of leaving points out, also where it is smoother.
TEST(RadialInterpolant, KnowsHowFarASmootherOneIsOff) {
  const MatrixXd points = ScatteredPoints(2, 40);
  const MatrixXd values = ValuesOf(points, Waves);
  const RadialInterpolant all = RadialInterpolant::Fit(points, values, 1e-2).value();
  for (const Eigen::Index left_out : {0, 17, 39}) {
    MatrixXd others(2, 39), of_others(2, 39);
    for (Eigen::Index i = 0, next = 0; i < 40; ++i) {
      if (i == left_out) continue;
      others.col(next) = points.col(i);
      of_others.col(next++) = values.col(i);
    }
    const RadialInterpolant without = RadialInterpolant::Fit(others, of_others, 1e-2).value();
    EXPECT_NEAR((without.At(points.col(left_out)) - values.col(left_out)).norm(),
                all.left_out_errors()[left_out], 1e-9);
  }
}

TEST(RadialInterpolant, RefusesTooFewPoints) {
  const MatrixXd few = ScatteredPoints(3, 5);
  EXPECT_EQ(DetailOf(RadialInterpolant::Fit(few, MatrixXd::Zero(1, 5)).status()).reason,
            "TOO_FEW_POINTS");
  EXPECT_FALSE(RadialInterpolant::Fit(MatrixXd::Zero(2, 30), MatrixXd::Zero(1, 30)).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(
      RadialInterpolant::Fit(ScatteredPoints(2, 30), MatrixXd::Zero(1, 29)).status()));
}

}  // namespace
}  // namespace mortise::retrieval
