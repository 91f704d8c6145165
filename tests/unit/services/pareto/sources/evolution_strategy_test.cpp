#include "services/pareto/sources/evolution_strategy.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomRotation(Eigen::Index size, Random& random) {
  MatrixXd columns(size, size);
  for (Eigen::Index j = 0; j < size; ++j) columns.col(j) = random.UnitVector(size);
  return Eigen::HouseholderQR<MatrixXd>(columns).householderQ();
}

// The least value seen within `generations`.
double MinimizeBy(EvolutionStrategy& strategy, Random& random, int generations,
                  const std::function<double(const VectorXd&)>& function) {
  double least = function(strategy.mean());
  for (int generation = 0; generation < generations; ++generation) {
    std::vector<VectorXd> samples;
    for (int i = 0; i < strategy.samples(); ++i) samples.push_back(strategy.Sample(random));
    std::ranges::stable_sort(samples, {}, function);
    least = std::min(least, function(samples.front()));
    strategy.Learn(samples);
  }
  return least;
}

TEST(EvolutionStrategy, SamplesStayWithinTheBoundsAndAreTheSameForASeed) {
  EvolutionStrategy strategy(VectorXd::Constant(5, 0.02), 0.5);
  Random random(4), again(4);
  for (int n = 0; n < 500; ++n) {
    const VectorXd u = strategy.Sample(random);
    EXPECT_GE(u.minCoeff(), 0);
    EXPECT_LE(u.maxCoeff(), 1);
    EXPECT_EQ(u, strategy.Sample(again));
  }
}

// Convergence in a straight line on a logarithmic scale, as the strategy is known for.
TEST(EvolutionStrategy, ConvergesOnASphere) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    EvolutionStrategy strategy(VectorXd::Constant(10, 0.2), 0.1);
    const auto sphere = [](const VectorXd& u) { return (u.array() - 0.6).matrix().squaredNorm(); };
    EXPECT_LT(MinimizeBy(strategy, random, 200, sphere), 1e-10);
  }
}

TEST(EvolutionStrategy, LearnsTheShapeOfATurnedEllipsoid) {
  Random random(2);
  const Eigen::Index size = 6;
  const MatrixXd rotation = RandomRotation(size, random);
  VectorXd axes(size);
  for (Eigen::Index i = 0; i < size; ++i) axes[i] = std::pow(1e3, i / (size - 1.0));
  const auto ellipsoid = [&](const VectorXd& u) {
    return axes.cwiseProduct(rotation * (u.array() - 0.45).matrix()).squaredNorm();
  };
  EvolutionStrategy strategy(VectorXd::Constant(size, 0.3), 0.1);
  EXPECT_LT(MinimizeBy(strategy, random, 600, ellipsoid), 1e-8);
}

// What it sees is an order: the logarithm of what it minimises makes no difference.
TEST(EvolutionStrategy, DependsOnTheOrderOfSamplesOnly) {
  const auto kinked = [](const VectorXd& u) { return (u.array() - 0.4).abs().sum() + 1e-3; };
  const auto squeezed = [&](const VectorXd& u) { return std::log(kinked(u)); };
  Random random(3), again(3);
  EvolutionStrategy one(VectorXd::Constant(4, 0.7), 0.1), other = one;
  const double least = MinimizeBy(one, random, 60, kinked);
  EXPECT_NEAR(std::log(least), MinimizeBy(other, again, 60, squeezed), 1e-12);
  EXPECT_EQ(one.mean(), other.mean());
}

TEST(EvolutionStrategy, GoesOnFromAnotherMeanWithTheSizeAskedFor) {
  Random random(5);
  EvolutionStrategy strategy(VectorXd::Constant(3, 0.5), 0.1);
  MinimizeBy(strategy, random, 40, [](const VectorXd& u) {
    return std::abs(u[0] - 0.2) + 100 * std::abs(u[1] - 0.2) + std::abs(u[2] - 0.3);
  });
  const VectorXd elsewhere = VectorXd::Constant(3, 0.8);
  strategy.Restart(elsewhere, 0.01);
  EXPECT_EQ(strategy.mean(), elsewhere);
  EXPECT_NEAR(strategy.Reach(), 0.01, 1e-12);
}

}  // namespace
}  // namespace mortise::pareto
