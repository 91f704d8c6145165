#include "services/pareto/sources/coordinate_descent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

struct Descent {
  VectorXd u;  // of the least second metric
  double value = 0;
  int evaluations = 0;
};

// Two metrics, of which the second is the larger the larger `g` is. g < 0: the design fails.
Descent Descend(const std::function<double(const VectorXd&)>& g, const VectorXd& start, int lines,
                std::uint64_t seed, int evaluations = 2000) {
  Archive archive;
  Random random(seed);
  const auto entry_of = [&](const VectorXd& u) {
    ArchiveEntry entry{u, g(u) >= 0, {}, {}, {}};
    if (entry.evaluated) entry.metrics = Eigen::Vector2d(u[0], (1 + g(u)) * (2 - u[0]));
    return entry;
  };
  CoordinateDescent::Options options;
  options.lines = lines;
  options.evaluations = evaluations;
  const std::size_t first = archive.Add(entry_of(start));
  CoordinateDescent descent(options, archive, first, random);
  Descent search{start, g(start)};
  while (!descent.Finished() && search.evaluations < 10'000) {
    std::vector<VectorXd> points;
    while (const auto u = descent.Ask(archive)) points.push_back(*u);
    EXPECT_FALSE(points.empty());
    for (const VectorXd& u : points) {
      ++search.evaluations;
      EXPECT_GE(u.minCoeff(), 0);
      EXPECT_LE(u.maxCoeff(), 1);
      descent.Tell(archive, archive.Add(entry_of(u)));
      if (g(u) >= 0 && g(u) < search.value) {
        search.value = g(u);
        search.u = u;
      }
    }
  }
  EXPECT_TRUE(descent.Finished());
  return search;
}

VectorXd Somewhere(Eigen::Index size, std::uint64_t seed) {
  Random random(seed);
  VectorXd u(size);
  for (double& value : u) value = random.Uniform();
  return u;
}

// Twenty local optima along each parameter but the first, their product in all.
TEST(CoordinateDescent, FindsTheBestOfMoreLocalOptimaThanCouldBeVisited) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const VectorXd best = Somewhere(8, seed);
    const auto g = [&](const VectorXd& u) {
      double sum = 0;
      for (Eigen::Index i = 1; i < u.size(); ++i) {
        const double y = 10 * (u[i] - best[i]);
        sum += y * y + 10 - 10 * std::cos(4 * std::numbers::pi * y);
      }
      return sum;
    };
    const Descent search = Descend(g, Somewhere(8, seed + 100), 4, seed);
    right += static_cast<int>(((search.u - best).tail(7).cwiseAbs().array() < 3e-3).count());
    EXPECT_LE(search.evaluations, 3 * 8 * 130);
  }
  EXPECT_GE(right, 33) << "of 35";
}

// What is right along each parameter by itself is wrong together.
TEST(CoordinateDescent, GoesDownhillWhereParametersActTogether) {
  for (const int lines : {1, 4}) {
    const auto valley = [](const VectorXd& u) {
      const double across = u[1] - u[2], along = u[1] + u[2] - 0.7;
      return 100 * across * across + along * along;
    };
    const Descent search = Descend(valley, Eigen::Vector4d(0.5, 0.9, 0.2, 0.5), lines, 1);
    EXPECT_LT(search.value, 2.0) << "from 49";
  }
}

TEST(CoordinateDescent, KeepsToItsEvaluations) {
  const auto g = [](const VectorXd& u) {
    return u.squaredNorm() + std::abs(std::sin(40 * u.sum()));
  };
  const Descent search = Descend(g, Somewhere(20, 1), 4, 1, 200);
  EXPECT_GE(search.evaluations, 200);
  EXPECT_LE(search.evaluations, 200 + 4 * 140) << "lines that have begun go on to their end";
}

TEST(CoordinateDescent, EndsWhereEverythingElseFails) {
  const VectorXd start = Somewhere(5, 1);
  const auto g = [&](const VectorXd& u) { return u == start ? 1.0 : -1.0; };
  EXPECT_EQ(Descend(g, start, 4, 1).value, 1);
}

}  // namespace
}  // namespace mortise::pareto
