#include "services/pareto/sources/population.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace mortise::pareto {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// Rastrigin's valley in every parameter but the first, which trades off: very many local optima.
Vector2d Rippled(const VectorXd& u) {
  double g = 1;
  for (Eigen::Index i = 1; i < u.size(); ++i) {
    const double x = 10 * u[i] - 4.3;
    g += x * x + 10 - 10 * std::cos(4 * M_PI * x);
  }
  return {u[0], g * (1 - std::sqrt(u[0] / g))};
}

std::size_t Add(Archive& archive, const VectorXd& u) {
  return archive.Add({u, true, Rippled(u), {}, {}});
}

TEST(Population, KeepsWhatIsNotDominatedAndApart) {
  Archive archive;
  Population population(4);
  // A line of trade-offs; of what is crowded on it, the middle goes.
  std::vector<std::size_t> entries;
  for (const double f : {0.0, 1.0, 0.5, 0.51}) {
    entries.push_back(archive.Add({VectorXd::Zero(2), true, Vector2d(f, 1 - f), {}, {}}));
    EXPECT_TRUE(population.Offer(archive, entries.back()));
  }
  const std::size_t dominated = archive.Add({VectorXd::Zero(2), true, Vector2d(0.8, 0.8), {}, {}});
  EXPECT_FALSE(population.Offer(archive, dominated));
  const std::size_t apart = archive.Add({VectorXd::Zero(2), true, Vector2d(0.75, 0.25), {}, {}});
  EXPECT_TRUE(population.Offer(archive, apart));
  EXPECT_EQ(population.size(), 4u);
  EXPECT_TRUE(population.Holds(entries[0]) && population.Holds(entries[1])) << "the ends stay";
  EXPECT_NE(population.Holds(entries[2]), population.Holds(entries[3])) << "one of the near two";
  const std::size_t best = archive.Add({VectorXd::Zero(2), true, Vector2d(-1, -1), {}, {}});
  EXPECT_TRUE(population.Offer(archive, best)) << "better than all";
}

TEST(Population, MakesChildrenWithinTheBoundsAndTheSameOnesForASeed) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Archive archive;
    Population population(10);
    Random random(seed), again(seed);
    for (int n = 0; n < 20; ++n) {
      VectorXd u(4);
      for (double& value : u) value = n % 3 == 0 ? std::round(random.Uniform()) : random.Uniform();
      population.Offer(archive, Add(archive, u));
    }
    again = random;
    std::set<Population::Way> ways;
    for (int n = 0; n < 300; ++n) {
      const Population::Child child = population.MakeChild(archive, random);
      EXPECT_GE(child.u.minCoeff(), 0);
      EXPECT_LE(child.u.maxCoeff(), 1);
      EXPECT_EQ(child.u, population.MakeChild(archive, again).u);
      ways.insert(child.way);
    }
    EXPECT_EQ(ways.size(), 3u);
  }
}

// 24 local optima in each of four parameters. Random designs of the same number stay far away.
TEST(Population, GetsThroughVeryManyLocalOptima) {
  int solved = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Archive archive;
    Population population(30);
    Random random(seed);
    double best = 1e9, of_random = 1e9;
    const auto valley = [](const Vector2d& f) { return f[1] + std::sqrt(std::max(f[0], 0.0)); };
    for (int n = 0; n < 2500; ++n) {
      VectorXd u(5), any(5);
      for (double& value : any) value = random.Uniform();
      u = any;
      if (n >= 30) {
        const Population::Child child = population.MakeChild(archive, random);
        u = child.u;
        const std::size_t entry = Add(archive, u);
        population.Report(child.way, population.Offer(archive, entry));
      } else {
        population.Offer(archive, Add(archive, u));
      }
      best = std::min(best, valley(Rippled(u)));
      of_random = std::min(of_random, valley(Rippled(any)));
    }
    EXPECT_GT(of_random, 3);
    solved += best < 1.3 ? 1 : 0;  // 1 is the optimum, the next valley 1.25
  }
  EXPECT_GE(solved, 4);
}

}  // namespace
}  // namespace mortise::pareto
