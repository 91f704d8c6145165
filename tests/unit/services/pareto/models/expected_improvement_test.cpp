// Expected hypervolume improvement against closed forms and against random draws.
#include "services/pareto/models/expected_improvement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/base/random.h"
#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<VectorXd> RoundFront(Index d, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<VectorXd> front;
  // On a sphere around (1, ..., 1), bent like a front, and one point that others dominate.
  for (int k = 0; k < count; ++k) {
    front.push_back(VectorXd::Ones(d) - random.UnitVector(d).cwiseAbs());
  }
  front.push_back(VectorXd::Constant(d, 0.95));
  return front;
}

double Normal(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.Uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.Uniform());
}

struct Draws {
  double mean = 0;
  double error = 0;  // standard error of the mean
};

Draws Drawn(const std::vector<VectorXd>& front, const VectorXd& reference, const VectorXd& means,
            const VectorXd& deviations, int draws) {
  Random random(3);
  const double before = Hypervolume(front, reference);
  std::vector<VectorXd> with = front;
  with.emplace_back();
  double sum = 0, squares = 0;
  for (int k = 0; k < draws; ++k) {
    VectorXd y = means;
    for (Index i = 0; i < y.size(); ++i) y[i] += deviations[i] * Normal(random);
    with.back() = y;
    const double gain = Hypervolume(with, reference) - before;
    sum += gain;
    squares += gain * gain;
  }
  const double mean = sum / draws;
  return {mean, std::sqrt((squares / draws - mean * mean) / draws)};
}

TEST(ExpectedImprovementTest, OfOneMetricIsThatOfTheBooks) {
  // Jones, Schonlau, Welch (1998): (f - mu) Phi(z) + sigma phi(z).
  const ExpectedHypervolumeImprovement improvement({VectorXd::Constant(1, 0.5)}, VectorXd::Ones(1));
  const double mean = 0.7, deviation = 0.4, z = (0.5 - mean) / deviation;
  const double expected = (0.5 - mean) * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
                          deviation * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  EXPECT_NEAR(improvement.Expected(VectorXd::Constant(1, mean), VectorXd::Constant(1, deviation)),
              expected, 1e-14);
}

TEST(ExpectedImprovementTest, OverAnEmptyFrontIsAProduct) {
  for (const Index d : {2, 3}) {
    const VectorXd means = VectorXd::LinSpaced(d, 0.2, 0.9);
    const VectorXd deviations = VectorXd::LinSpaced(d, 0.3, 0.1);
    double product = 1;
    for (Index k = 0; k < d; ++k) {
      product *= ExpectedHypervolumeImprovement({}, VectorXd::Ones(1))
                     .Expected(means.segment(k, 1), deviations.segment(k, 1));
    }
    EXPECT_NEAR(ExpectedHypervolumeImprovement({}, VectorXd::Ones(d)).Expected(means, deviations),
                product, 1e-14);
  }
}

TEST(ExpectedImprovementTest, WithoutDoubtIsTheImprovement) {
  for (const Index d : {2, 3}) {
    const std::vector<VectorXd> front = RoundFront(d, 9, 1);
    const VectorXd reference = VectorXd::Constant(d, 1.1);
    const ExpectedHypervolumeImprovement improvement(front, reference);
    Random random(5);
    for (int trial = 0; trial < 30; ++trial) {
      std::vector<VectorXd> with = front;
      with.push_back(VectorXd::Ones(d) - 1.3 * random.Uniform() * random.UnitVector(d).cwiseAbs());
      EXPECT_NEAR(improvement.Expected(with.back(), VectorXd::Constant(d, 1e-9)),
                  Hypervolume(with, reference) - Hypervolume(front, reference), 1e-7);
    }
  }
}

TEST(ExpectedImprovementTest, EqualsRandomDraws) {
  for (const Index d : {1, 2, 3, 4, 5}) {
    const std::vector<VectorXd> front = RoundFront(d, 8, 2);
    const VectorXd reference = VectorXd::Constant(d, 1.1);
    const ExpectedHypervolumeImprovement improvement(front, reference);
    for (const double height : {0.1, 0.5, 0.8}) {
      const VectorXd means = VectorXd::Constant(d, height) + VectorXd::LinSpaced(d, -0.1, 0.1);
      const VectorXd deviations = VectorXd::LinSpaced(d, 0.1, 0.3);
      const Draws drawn = Drawn(front, reference, means, deviations, 4000);
      const double rays = d <= 3 ? 0 : 0.1 * drawn.mean;
      EXPECT_NEAR(improvement.Expected(means, deviations), drawn.mean, 4 * drawn.error + rays)
          << d << " metrics, " << height;
    }
  }
}

TEST(ExpectedImprovementTest, IsNeverNegativeAndFallsWithDistance) {
  for (const Index d : {2, 3, 5}) {
    const std::vector<VectorXd> front = RoundFront(d, 12, 4);
    const ExpectedHypervolumeImprovement improvement(front, VectorXd::Constant(d, 1.1));
    double last = 1e9;
    for (double height = -0.5; height < 3; height += 0.1) {
      const double expected =
          improvement.Expected(VectorXd::Constant(d, height), VectorXd::Constant(d, 0.1));
      EXPECT_GE(expected, 0);
      EXPECT_LE(expected, last);
      last = expected;
    }
  }
}

TEST(ExpectedImprovementTest, GradientsAreItsSlopes) {
  for (const Index d : {1, 2, 3, 4}) {
    const ExpectedHypervolumeImprovement improvement(RoundFront(d, 7, 6),
                                                     VectorXd::Constant(d, 1.1));
    const VectorXd means = VectorXd::LinSpaced(d, 0.25, 0.6);
    const VectorXd deviations = VectorXd::LinSpaced(d, 0.1, 0.2);
    const auto value = improvement.WithGradient(means, deviations);
    const double step = 1e-6;
    const double tolerance = (d <= 3 ? 1e-6 : 1e-2) * std::max(1e-3, value.expected) + 1e-8;
    for (Index i = 0; i < d; ++i) {
      const VectorXd move = step * VectorXd::Unit(d, i);
      EXPECT_NEAR(value.mean_gradient[i],
                  (improvement.Expected(means + move, deviations) -
                   improvement.Expected(means - move, deviations)) /
                      (2 * step),
                  tolerance);
      EXPECT_NEAR(value.deviation_gradient[i],
                  (improvement.Expected(means, deviations + move) -
                   improvement.Expected(means, deviations - move)) /
                      (2 * step),
                  tolerance);
    }
  }
}

}  // namespace
}  // namespace mortise::pareto
