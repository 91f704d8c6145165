// Hypervolume against closed forms, inclusion and exclusion, and counting; dominance.
#include "services/pareto/archive/hypervolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/base/random.h"
#include "services/pareto/archive/non_dominated.h"

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

Eigen::MatrixXd Columns(const std::vector<VectorXd>& points, Eigen::Index d) {
  Eigen::MatrixXd columns(d, static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    columns.col(i) = points[static_cast<std::size_t>(i)];
  }
  return columns;
}

// By inclusion and exclusion of the boxes of all subsets.
double ByInclusionAndExclusion(const std::vector<VectorXd>& points, const VectorXd& reference) {
  double volume = 0;
  for (unsigned subset = 1; subset < 1u << points.size(); ++subset) {
    VectorXd worst = VectorXd::Constant(reference.size(), -1e300);
    int members = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if ((subset >> i & 1u) == 0) continue;
      worst = worst.cwiseMax(points[i]);
      ++members;
    }
    volume += (members % 2 == 1 ? 1 : -1) * (reference - worst).cwiseMax(0.0).prod();
  }
  return volume;
}

// Of points of a simplex whose coordinates are multiples of 1 / steps.
std::vector<VectorXd> SimplexLattice(Eigen::Index d, int steps) {
  std::vector<VectorXd> points;
  Eigen::VectorXi counts = Eigen::VectorXi::Zero(d);
  const auto fill = [&](auto&& self, Eigen::Index i, int left) -> void {
    if (i + 1 == d) {
      counts[i] = left;
      points.push_back(counts.cast<double>() / steps);
      return;
    }
    for (counts[i] = 0; counts[i] <= left; ++counts[i]) self(self, i + 1, left - counts[i]);
  };
  fill(fill, 0, steps);
  return points;
}

class HypervolumeOfMetrics : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Metrics, HypervolumeOfMetrics, testing::Range(1, 7));

TEST_P(HypervolumeOfMetrics, IsThatOfInclusionAndExclusion) {
  const Eigen::Index d = GetParam();
  const VectorXd reference = VectorXd::Constant(d, 0.9);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto points = RandomPoints(9, d, seed);
    points.push_back(points[3]);
    points.push_back(points[5]);  // the same in all metrics but one
    points.back()[0] *= 0.5;
    EXPECT_NEAR(Hypervolume(points, reference), ByInclusionAndExclusion(points, reference), 1e-12)
        << seed;
  }
}

// Points of a simplex lattice dominate exactly the lattice's cubes beyond it.
TEST_P(HypervolumeOfMetrics, OfALinearFrontIsTheNumberOfCubesBeyondIt) {
  const int d = GetParam();
  const int steps = d <= 3 ? 12 : d == 4 ? 8 : 5;
  const auto points = SimplexLattice(d, steps);
  // Cube k_1 ... k_d is dominated if some lattice point is below its lower corner: sum k >= steps.
  std::vector<double> ways(static_cast<std::size_t>(steps), 0.0);  // of sums below `steps`
  ways[0] = 1;
  for (int i = 0; i < d; ++i) {
    for (std::size_t sum = 1; sum < ways.size(); ++sum) ways[sum] += ways[sum - 1];
  }
  double below = 0;
  for (const double count : ways) below += count;
  EXPECT_NEAR(Hypervolume(points, VectorXd::Ones(d)), 1 - below / std::pow(steps, d), 1e-12);
}

TEST_P(HypervolumeOfMetrics, AddsUpFromContributionsInAnyOrder) {
  const Eigen::Index d = GetParam();
  const VectorXd reference = VectorXd::Constant(d, 0.95);
  auto points = RandomPoints(40, d, 17);
  const double whole = Hypervolume(points, reference);
  for (int order = 0; order < 2; ++order) {
    double sum = 0;
    std::vector<VectorXd> before;
    for (const VectorXd& point : points) {
      const double gain = HypervolumeContribution(point, Columns(before, d), reference);
      EXPECT_GE(gain, 0);
      sum += gain;
      before.push_back(point);
    }
    EXPECT_NEAR(sum, whole, 1e-12);
    std::ranges::reverse(points);
    EXPECT_NEAR(Hypervolume(points, reference), whole, 1e-12);
  }
}

TEST_P(HypervolumeOfMetrics, ContributionsAreBoundedFromAboveByThoseToSome) {
  const Eigen::Index d = GetParam();
  const VectorXd reference = VectorXd::Ones(d);
  Random random(3);
  std::vector<VectorXd> front;
  for (int i = 0; i < 80; ++i) front.push_back(random.UnitVector(d).cwiseAbs());
  const Eigen::MatrixXd columns = Columns(front, d);
  for (int i = 0; i < 20; ++i) {
    const VectorXd point = 0.97 * random.UnitVector(d).cwiseAbs();
    const double exact = HypervolumeContribution(point, columns, reference);
    double last = exact;
    for (const std::size_t most : {40, 10, 2}) {
      const double bound = HypervolumeContribution(point, columns, reference, most);
      EXPECT_GE(bound, last - 1e-12);
      last = bound;
    }
    EXPECT_LE(last, (reference - point).cwiseMax(0.0).prod() + 1e-12);
  }
}

TEST_P(HypervolumeOfMetrics, IsAboutThatOfSamples) {
  const Eigen::Index d = GetParam();
  const auto points = RandomPoints(60, d, 23);
  const VectorXd reference = VectorXd::Ones(d);
  EXPECT_NEAR(SampledHypervolume(points, reference, 1 << 14), Hypervolume(points, reference), 0.01);
  EXPECT_EQ(SampledHypervolume({}, reference, 100), 0);
}

TEST(HypervolumeTest, OfAPartOfTheSphereInFiveMetrics) {
  Random random(6);
  std::vector<VectorXd> sphere;
  for (int i = 0; i < 400; ++i) sphere.push_back(random.UnitVector(5).cwiseAbs());
  const VectorXd reference = VectorXd::Constant(5, 1.1);
  const double truth = std::pow(1.1, 5) - 8 * M_PI * M_PI / 15 / 32;
  const double found = Hypervolume(sphere, reference);
  EXPECT_LT(found, truth);
  EXPECT_GT(found, 0.7 * truth);
  EXPECT_NEAR(QuickHypervolume(sphere, reference, 1 << 14), found, 0.02);
}

TEST(HypervolumeTest, AgreesWithCountingInThreeAndFourDimensions) {
  for (const Eigen::Index d : {3, 4}) {
    const auto points = RandomPoints(30, d, 5);
    const auto samples = RandomPoints(20000, d, 9);
    int dominated = 0;
    for (const VectorXd& sample : samples) {
      dominated += std::any_of(points.begin(), points.end(), [&](const VectorXd& p) {
        return (p.array() <= sample.array()).all();
      });
    }
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
