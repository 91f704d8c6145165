#include "services/pareto/sources/coordinate_search.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

// Two metrics that both fall where the second parameter is right, however the first is.
VectorXd Metrics(const VectorXd& u, double ripples) {
  const double x = u[1] - 0.37;
  const double g = 1 + 10 * x * x + 0.3 * (1 - std::cos(ripples * x));
  return Eigen::Vector2d(g * (1 + u[0]), g * (2 - u[0]));
}

struct Search {
  double reached = 1;  // distance of the best from 0.37
  int evaluations = 0;
};

Search Follow(double start, int values, double ripples, std::uint64_t seed, bool fails = false) {
  Archive archive;
  Random random(seed);
  const Scaling scaling{VectorXd::Zero(2), VectorXd::Ones(2)};
  const Eigen::Vector2d from(0.4, start);
  const std::size_t entry = archive.Add({from, true, Metrics(from, ripples), {}, {}});
  CoordinateSearch search(archive, scaling, {Eigen::Vector2d(0.5, 0.5), {}, 1}, entry, 1, values,
                          random);
  Search result;
  double best = (Metrics(from, ripples) - VectorXd::Constant(2, 0.5)).norm();
  result.reached = std::abs(start - 0.37);
  while (!search.Finished() && result.evaluations < 100) {
    const auto u = search.Ask(archive);
    if (!u) break;
    EXPECT_EQ((*u)[0], 0.4) << "only one parameter changes";
    EXPECT_GE(u->minCoeff(), 0);
    EXPECT_LE(u->maxCoeff(), 1);
    ++result.evaluations;
    if (fails) {
      search.Tell(archive, archive.Add({*u, false, {}, {}, {}}));
      continue;
    }
    const VectorXd metrics = Metrics(*u, ripples);
    search.Tell(archive, archive.Add({*u, true, metrics, {}, {}}));
    const double distance = (metrics - VectorXd::Constant(2, 0.5)).norm();
    if (distance < best) {
      best = distance;
      result.reached = std::abs((*u)[1] - 0.37);
    }
  }
  EXPECT_TRUE(search.Finished());
  return result;
}

TEST(CoordinateSearch, FollowsAParabolaToItsVertex) {
  for (const double start : {0.355, 0.36, 0.375, 0.385}) {
    const Search search = Follow(start, 0, 0, 1);
    EXPECT_LT(search.reached, 1e-4) << start;
    EXPECT_LE(search.evaluations, 9);
  }
}

TEST(CoordinateSearch, LooksAnywhereAndThenNearby) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Search search = Follow(0.95, 8, 0, seed);
    EXPECT_LT(search.reached, 0.2) << "the best of eight values anywhere";
    EXPECT_LE(search.evaluations, 17);
    found += search.reached < 0.05 ? 1 : 0;
  }
  EXPECT_GE(found, 10);
}

// What is best is a bound, and all between is worse than where the search begins.
TEST(CoordinateSearch, FindsTheBestAtABound) {
  Random random(2);
  int found = 0;
  for (int round = 0; round < 20; ++round) {
    const auto metrics = [](const VectorXd& u) -> VectorXd {
      return VectorXd::Constant(2, u[0] >= 1 ? 0.5 : 1 + u[0]);
    };
    Archive archive;
    const VectorXd from = VectorXd::Constant(1, 0.1);
    const std::size_t entry = archive.Add({from, true, metrics(from), {}, {}});
    const Scaling scaling{VectorXd::Zero(2), VectorXd::Ones(2)};
    CoordinateSearch search(archive, scaling, {VectorXd::Zero(2), {}, 1}, entry, 0, 8, random);
    bool reached = false;
    while (const auto u = search.Ask(archive)) {
      reached = reached || (*u)[0] == 1;
      search.Tell(archive, archive.Add({*u, true, metrics(*u), {}, {}}));
    }
    found += reached ? 1 : 0;
  }
  EXPECT_GE(found, 5);
}

TEST(CoordinateSearch, LeavesLocalOptima) {
  int left = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    left += Follow(0.37 + 0.3, 8, 2 * M_PI / 0.1, seed).reached < 0.2 ? 1 : 0;
  }
  EXPECT_GE(left, 15);
}

TEST(CoordinateSearch, EndsWhereNothingIsFeasible) {
  EXPECT_EQ(Follow(0.5, 8, 0, 1, true).evaluations, 8);
  EXPECT_LE(Follow(0.5, 0, 0, 1, true).evaluations, 9);
}

}  // namespace
}  // namespace mortise::pareto
