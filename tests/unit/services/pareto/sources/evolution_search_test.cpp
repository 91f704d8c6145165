#include "services/pareto/sources/evolution_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr Eigen::Index kKinkedParameters = 6;

// A front along the first parameter where all others are 0.4, away from which both metrics rise
// with kinks that are turned against the parameters.
Vector2d Kinked(const VectorXd& u) {
  double distance = 0, before = 0;
  for (Eigen::Index i = 1; i < u.size(); ++i) {
    distance += std::abs(u[i] - 0.4 + 0.5 * before);
    before = u[i] - 0.4;
  }
  return {u[0] * u[0] + distance, (1 - u[0]) * (1 - u[0]) + distance};
}

std::size_t AddKinked(Archive& archive, const VectorXd& u) {
  return archive.Add({u, true, Kinked(u), {}, {}});
}

Archive FarFromTheFront() {
  Archive archive;
  Random random(1);
  for (int n = 0; n < 12; ++n) {
    VectorXd u(kKinkedParameters);
    for (double& value : u) value = random.Uniform();
    AddKinked(archive, u);
  }
  return archive;
}

// The distance to the front where the search has come to.
double Advance(Archive& archive, EvolutionSearch& search, int evaluations) {
  double least = 1e9;
  for (int n = 0; n < evaluations; ++n) {
    const auto sample = search.Next(archive, archive.CurrentScaling());
    const std::size_t entry = AddKinked(archive, sample.u);
    search.Tell(archive, archive.CurrentScaling(), sample.search, entry);
    const double excess = Kinked(sample.u)[0] - sample.u[0] * sample.u[0];
    least = std::min(least, excess);
  }
  return least;
}

TEST(EvolutionSearch, GoesDownWhereMetricsHaveKinks) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Archive archive = FarFromTheFront();
    EvolutionSearch search(seed);
    EXPECT_EQ(search.Promise(), 1);
    EXPECT_LT(Advance(archive, search, 800), 0.01);
  }
}

TEST(EvolutionSearch, IsTheSameForASeed) {
  Archive one = FarFromTheFront(), other = FarFromTheFront();
  EvolutionSearch first(7), second(7);
  EXPECT_EQ(Advance(one, first, 300), Advance(other, second, 300));
  EXPECT_EQ(one[one.size() - 1].u, other[other.size() - 1].u);
}

TEST(EvolutionSearch, AddsToTheFrontOnceTheFirstSearchIsOver) {
  Archive archive = FarFromTheFront();
  EvolutionSearch search(2);
  const auto dominated = [&] {
    std::vector<VectorXd> points;
    for (const std::size_t entry : archive.non_dominated()) {
      points.push_back(archive[entry].metrics);
    }
    return Hypervolume(points, Vector2d(1.5, 1.5));
  };
  while (search.Promise() > 0) Advance(archive, search, 20);
  const double first = dominated();
  Advance(archive, search, 1500);
  EXPECT_GT(dominated(), first + 0.01);
}

TEST(EvolutionSearch, IgnoresFailuresAndWhatViolatesConstraints) {
  Archive archive;
  archive.Add(
      {VectorXd::Constant(2, 0.5), true, Vector2d(1, 1), {}, {}, VectorXd::Constant(1, -1)});
  EvolutionSearch search(3);
  const VectorXd before = archive[0].u;
  for (int n = 0; n < 200; ++n) {
    const auto sample = search.Next(archive, archive.CurrentScaling());
    ArchiveEntry entry{sample.u, n % 3 != 0, {}, {}, {}};
    if (entry.evaluated) {
      // Better and better to the right, where it is not allowed beyond 0.6.
      entry.metrics = Vector2d(2 - 2 * sample.u[0], 2 - 2 * sample.u[0]);
      entry.constraints = VectorXd::Constant(1, sample.u[0] - 0.6);
    }
    const std::size_t index = archive.Add(std::move(entry));
    search.Tell(archive, archive.CurrentScaling(), sample.search, index);
  }
  for (const std::size_t entry : archive.non_dominated()) {
    EXPECT_LE(archive[entry].u[0], 0.6);
    EXPECT_GT(archive[entry].u[0], 0.59);
  }
}

// What brought one trade-off nearer to the front is done to another, once.
TEST(EvolutionSearch, TransfersWhatItGainedToOtherTradeOffs) {
  Archive archive;
  const auto at = [](double first, double others) {
    VectorXd u = VectorXd::Constant(kKinkedParameters, others);
    u[0] = first;
    return u;
  };
  const std::size_t left = AddKinked(archive, at(0, 0.7)), right = AddKinked(archive, at(1, 0.7));
  AddKinked(archive, at(0.5, 0.7));
  EvolutionSearch search(1);
  EXPECT_TRUE(search.Transfers(archive, 8).empty()) << "nothing gained yet";
  Advance(archive, search, 300);
  const double before = std::min(archive[left].metrics[1], archive[right].metrics[0]);
  double best = 1e9;
  for (const VectorXd& u : search.Transfers(archive, 8)) {
    EXPECT_GE(u.minCoeff(), 0);
    EXPECT_LE(u.maxCoeff(), 1);
    best = std::min({best, Kinked(u)[0], Kinked(u)[1]});
  }
  EXPECT_LT(best, before);
}

}  // namespace
}  // namespace mortise::pareto
