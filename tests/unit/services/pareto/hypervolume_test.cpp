// Hypervolume against closed forms and counting; dominance.
#include "services/pareto/hypervolume.h"

#include <gtest/gtest.h>

#include <cmath>

#include "services/pareto/non_dominated.h"
#include "services/pareto/random.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

std::vector<VectorXd> RandomPoints(int count, Eigen::Index d, std::uint64_t seed) {
  Random random(seed);
  std::vector<VectorXd> points;
  for (int i = 0; i < count; ++i) {
    VectorXd p(d);
    for (double& value : p) value = random.Uniform();
    points.push_back(p);
  }
  return points;
}

TEST(HypervolumeTest, OfBoxes) {
  const VectorXd reference = VectorXd::Ones(2);
  EXPECT_EQ(Hypervolume({}, reference), 0);
  EXPECT_DOUBLE_EQ(Hypervolume({Eigen::Vector2d(0.5, 0.5)}, reference), 0.25);
  EXPECT_DOUBLE_EQ(Hypervolume({Eigen::Vector2d(0.2, 0.6), Eigen::Vector2d(0.6, 0.2)}, reference),
                   0.8 * 0.4 + 0.4 * 0.4);
  EXPECT_EQ(Hypervolume({Eigen::Vector2d(1.0, 0.0)}, reference), 0);  // on the reference
}

TEST(HypervolumeTest, OfAQuarterCircleAndAnOctantOfASphere) {
  std::vector<VectorXd> circle, sphere;
  constexpr int kSteps = 2000;
  for (int i = 0; i <= kSteps; ++i) {
    const double a = M_PI / 2 * i / kSteps;
    circle.push_back(Eigen::Vector2d(std::cos(a), std::sin(a)));
  }
  EXPECT_NEAR(Hypervolume(circle, VectorXd::Constant(2, 1.1)), 1.21 - M_PI / 4, 2e-3);
  for (int i = 0; i <= 120; ++i) {
    for (int j = 0; j <= 120; ++j) {
      const double a = M_PI / 2 * i / 120, b = M_PI / 2 * j / 120;
      sphere.push_back(
          Eigen::Vector3d(std::cos(a) * std::cos(b), std::cos(a) * std::sin(b), std::sin(a)));
    }
  }
  const double truth = 1.331 - M_PI / 6;
  const double found = Hypervolume(sphere, VectorXd::Constant(3, 1.1));
  EXPECT_LT(found, truth);
  EXPECT_NEAR(found, truth, 0.02);
}

TEST(HypervolumeTest, AgreesWithCountingInThreeAndFourDimensions) {
  for (const Eigen::Index d : {3, 4}) {
    const auto points = RandomPoints(30, d, 5);
    const auto samples = RandomPoints(20000, d, 9);
    int dominated = 0;
    for (const VectorXd& sample : samples)
      dominated += std::any_of(points.begin(), points.end(), [&](const VectorXd& p) {
        return (p.array() <= sample.array()).all();
      });
    EXPECT_NEAR(Hypervolume(points, VectorXd::Ones(d)), dominated / 20000.0, 0.015) << d;
  }
}

TEST(HypervolumeTest, DoesNotDependOnOrderOrDominatedPoints) {
  auto points = RandomPoints(60, 3, 3);
  const VectorXd reference = VectorXd::Ones(3);
  const double whole = Hypervolume(points, reference);
  std::reverse(points.begin(), points.end());
  EXPECT_NEAR(Hypervolume(points, reference), whole, 1e-12);
  std::vector<VectorXd> front;
  for (const std::size_t i : NonDominated(points)) front.push_back(points[i]);
  EXPECT_NEAR(Hypervolume(front, reference), whole, 1e-12);
}

TEST(NonDominatedTest, KeepsExactlyWhatNothingDominates) {
  const auto points = RandomPoints(200, 3, 11);
  const auto kept = NonDominated(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool dominated = std::any_of(points.begin(), points.end(), [&](const VectorXd& other) {
      return Dominates(other, points[i]);
    });
    EXPECT_EQ(std::find(kept.begin(), kept.end(), i) == kept.end(), dominated);
  }
  EXPECT_EQ(NonDominated({VectorXd::Ones(2), VectorXd::Ones(2)}).size(), 1u);
}

}  // namespace
}  // namespace mortise::pareto
