#include "services/pareto/sources/line_minimum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

namespace mortise::pareto {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

struct LineSearch {
  double point = 0;
  double value = kNowhere;
  int evaluations = 0;
  int rounds = 0;  // of points asked for side by side
};

LineSearch Minimize(const std::function<double(double)>& f, double known, std::uint64_t seed,
                    LineMinimum::Options options = {}) {
  Random random(seed);
  LineMinimum line(options, known, f(known), random);
  LineSearch search{known, f(known)};
  while (!line.Finished() && search.evaluations < 1000) {
    std::vector<double> points;
    while (const auto point = line.Ask()) points.push_back(*point);
    EXPECT_FALSE(points.empty());
    ++search.rounds;
    for (const double point : points) {
      EXPECT_GE(point, 0);
      EXPECT_LE(point, 1);
      ++search.evaluations;
      if (f(point) < search.value) search = {point, f(point), search.evaluations, search.rounds};
      line.Tell(point, f(point));
    }
  }
  EXPECT_TRUE(line.Finished());
  EXPECT_FALSE(line.Ask());
  return search;
}

TEST(LineMinimum, TakesFewPointsForAParabola) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double at = 0.05 + 0.045 * static_cast<double>(seed);
    const LineSearch search =
        Minimize([&](double x) { return 2 + (x - at) * (x - at); }, 0.5, seed);
    EXPECT_NEAR(search.point, at, 2e-3) << seed;
    EXPECT_LE(search.evaluations, 20);
  }
}

TEST(LineMinimum, FindsTheLeastOfTwentyValleys) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const double at = random.Uniform();
    const auto rastrigin = [&](double x) {
      const double y = 10 * (x - at);
      return y * y + 10 - 10 * std::cos(4 * std::numbers::pi * y);
    };
    const LineSearch search = Minimize(rastrigin, random.Uniform(), seed);
    found += std::abs(search.point - at) < 2e-3 ? 1 : 0;
    EXPECT_LE(search.evaluations, 140);
    EXPECT_LE(search.rounds, 14);
  }
  EXPECT_GE(found, 48);
}

TEST(LineMinimum, FindsTheEnds) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_EQ(Minimize([](double x) { return x; }, 0.4, seed).point, 0);
    EXPECT_EQ(Minimize([](double x) { return -std::sqrt(x); }, 0.4, seed).point, 1);
    EXPECT_EQ(Minimize([](double x) { return std::abs(x); }, 0, seed).point, 0);
  }
}

TEST(LineMinimum, EndsWhereThereIsNothingToFind) {
  const LineSearch flat = Minimize([](double) { return 3; }, 0.4, 1);
  EXPECT_EQ(flat.value, 3);
  EXPECT_EQ(Minimize([](double) { return kNowhere; }, 0.4, 1).value, kNowhere);
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Minimize([&](double x) { return x == 0.4 ? 1 : none; }, 0.4, 1).value, 1);
  // Half of the range fails.
  const auto half = [](double x) { return x < 0.5 ? kNowhere : (x - 0.6) * (x - 0.6); };
  EXPECT_NEAR(Minimize(half, 0.9, 1).point, 0.6, 5e-3);
}

TEST(LineMinimum, KeepsToItsLimit) {
  LineMinimum::Options options;
  options.values = 16;
  Random noise(3);
  Random random(1);
  LineMinimum line(options, 0.5, 1, random);
  int evaluations = 0;
  while (!line.Finished()) {
    while (const auto point = line.Ask()) {
      ++evaluations;
      line.Tell(*point, noise.Uniform());
    }
  }
  EXPECT_LE(evaluations, 2 * 16 + 16 + 8 + 4 + 2 + 4);
}

// What is asked between two values that can be set is answered at one of them, again and again.
TEST(LineMinimum, EndsWhereValuesAreRounded) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    LineMinimum line({.values = 64}, 0, 0, random);
    int asked = 0;
    while (const auto point = line.Ask()) {
      ASSERT_LT(++asked, 200);
      const double rounded = std::round(10 * *point) / 10;
      line.Tell(rounded, std::fmod(10 * rounded, 2) + rounded);
    }
    EXPECT_TRUE(line.Finished());
  }
}

}  // namespace
}  // namespace mortise::pareto
