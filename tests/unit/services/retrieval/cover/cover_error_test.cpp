// Errors of covers that are known to be good or bad.
#include "services/retrieval/cover/cover_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

// A tangent at the middle of a straight line of length 1, along it and of this radius.
std::vector<Primitive> MiddleOfLine(double radius) {
  const VectorXd direction = VectorXd::Constant(10, 1 / std::sqrt(10.0));
  return {{.parameters = VectorXd::Constant(1, 0.5 * (std::sqrt(5.0) - 1)),
           .center = 0.5 * direction,
           .axes = direction,
           .radii = VectorXd::Constant(1, radius)}};
}

TEST(CoverError, CoverageIsTheDistanceOfWhatIsLeft) {
  const FunctionManifold line(testing::Line(1));
  ASSERT_OK_AND_ASSIGN(const auto errors,
                       CoverageErrors(line, MiddleOfLine(0.3), {.count = 4000, .seed = 2}));
  EXPECT_NEAR(errors.back(), 0.2, 0.01);
  EXPECT_NEAR(Quantile(errors, 0.5), 0, 1e-7);
}

TEST(CoverError, FittingIsWhatStandsOut) {
  const FunctionManifold line(testing::Line(1));
  ASSERT_OK_AND_ASSIGN(const auto tight,
                       FittingErrors(line, MiddleOfLine(0.5), {.count = 200, .seed = 2}));
  EXPECT_LT(tight.back(), 1e-3);
  ASSERT_OK_AND_ASSIGN(const auto loose,
                       FittingErrors(line, MiddleOfLine(0.6), {.count = 2000, .seed = 2}));
  EXPECT_NEAR(loose.back(), 0.1, 0.01);
}

TEST(CoverError, PointsHaveNoFittingError) {
  const FunctionManifold line(testing::Line(1));
  std::vector<Primitive> points = MiddleOfLine(1);
  points[0].axes.resize(10, 0);
  points[0].radii.resize(0);
  ASSERT_OK_AND_ASSIGN(const auto errors, FittingErrors(line, points, {}));
  EXPECT_TRUE(errors.empty());
}

TEST(CoverError, QuantilesAreThoseOfTheList) {
  EXPECT_EQ(Quantile({}, 0.99), 0);
  EXPECT_EQ(Quantile({1, 2, 3, 4}, 0.5), 2);
  EXPECT_EQ(Quantile({1, 2, 3, 4}, 0.51), 3);
  EXPECT_EQ(Quantile({1, 2, 3, 4}, 1), 4);
  EXPECT_EQ(Quantile({1, 2, 3, 4}, 0), 1);
}

}  // namespace
}  // namespace mortise::retrieval
