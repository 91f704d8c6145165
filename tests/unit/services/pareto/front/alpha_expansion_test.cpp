#include "services/pareto/front/alpha_expansion.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/base/errors.h"
#include "common/base/random.h"

namespace mortise::pareto {
namespace {

// Sites in a row or a grid, some of the labels at each with random costs.
LabelingProblem RandomProblem(int rows, int columns, int labels, double weight,
                              std::uint64_t seed) {
  Random random(seed);
  LabelingProblem problem;
  problem.labels = labels;
  problem.weight = weight;
  for (int j = 0; j < rows * columns; ++j) {
    auto& candidates = problem.candidates.emplace_back();
    for (int label = 0; label < labels; ++label) {
      if (label == j % labels || random.Uniform() < 0.7) {
        candidates.push_back({label, random.Uniform()});
      }
    }
    if (j % columns > 0) problem.neighbours.emplace_back(j - 1, j);
    if (j >= columns) problem.neighbours.emplace_back(j - columns, j);
  }
  return problem;
}

double LeastEnergy(const LabelingProblem& problem) {
  std::vector<std::size_t> choice(problem.candidates.size(), 0);
  double least = std::numeric_limits<double>::infinity();
  while (true) {
    std::vector<int> labels;
    for (std::size_t j = 0; j < choice.size(); ++j) {
      labels.push_back(problem.candidates[j][choice[j]].label);
    }
    least = std::min(least, LabelingEnergy(problem, labels));
    std::size_t j = 0;
    while (j < choice.size() && ++choice[j] == problem.candidates[j].size()) choice[j++] = 0;
    if (j == choice.size()) return least;
  }
}

bool AreCandidates(const LabelingProblem& problem, const std::vector<int>& labels) {
  for (std::size_t j = 0; j < labels.size(); ++j) {
    bool is_there = false;
    for (const LabelCost& candidate : problem.candidates[j]) {
      is_there = is_there || candidate.label == labels[j];
    }
    if (!is_there) return false;
  }
  return labels.size() == problem.candidates.size();
}

// With two labels every cut is a labelling: one expansion to each finds the least energy.
TEST(AlphaExpansion, FindsTheLeastEnergyOfTwoLabels) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const LabelingProblem problem = RandomProblem(3, 4, 2, 0.1 * static_cast<double>(seed), seed);
    const auto labels = MinimizeByExpansion(problem);
    ASSERT_TRUE(labels.ok()) << labels.status();
    EXPECT_NEAR(LabelingEnergy(problem, *labels), LeastEnergy(problem), 1e-9) << seed;
  }
}

// Boykov, Veksler and Zabih 2001, theorem 6.1: within twice the least energy for Potts' model.
TEST(AlphaExpansion, StaysWithinItsBound) {
  int exact = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const LabelingProblem problem = RandomProblem(2, 4, 4, 0.02 * static_cast<double>(seed), seed);
    const auto labels = MinimizeByExpansion(problem);
    ASSERT_TRUE(labels.ok()) << labels.status();
    EXPECT_TRUE(AreCandidates(problem, *labels)) << seed;
    const double energy = LabelingEnergy(problem, *labels), least = LeastEnergy(problem);
    EXPECT_GE(energy, least - 1e-9);
    EXPECT_LE(energy, 2 * least + 1e-9);
    exact += energy < least + 1e-9 ? 1 : 0;
  }
  EXPECT_GT(exact, 50) << "it mostly finds the best";
}

// No site can do better by itself, nor all that border on one label.
TEST(AlphaExpansion, LeavesNothingThatASingleChangeWouldImprove) {
  const LabelingProblem problem = RandomProblem(12, 15, 6, 0.4, 7);
  const std::vector<int> labels = *MinimizeByExpansion(problem);
  EXPECT_TRUE(AreCandidates(problem, labels));
  const double energy = LabelingEnergy(problem, labels);
  for (std::size_t j = 0; j < labels.size(); ++j) {
    for (const LabelCost& candidate : problem.candidates[j]) {
      std::vector<int> changed = labels;
      changed[j] = candidate.label;
      EXPECT_GE(LabelingEnergy(problem, changed), energy - 1e-9);
    }
  }
  EXPECT_EQ(*MinimizeByExpansion(problem), labels) << "the same again";
}

TEST(AlphaExpansion, TakesTheCheapestWhereNeighboursDoNotMatter) {
  LabelingProblem problem = RandomProblem(4, 4, 5, 0, 3);
  const std::vector<int> labels = *MinimizeByExpansion(problem);
  double least = 0;
  for (const auto& candidates : problem.candidates) {
    double cheapest = candidates[0].cost;
    for (const LabelCost& candidate : candidates) cheapest = std::min(cheapest, candidate.cost);
    least += cheapest;
  }
  EXPECT_NEAR(LabelingEnergy(problem, labels), least, 1e-12);
  EXPECT_TRUE(MinimizeByExpansion({})->empty());
}

TEST(AlphaExpansion, RefusesBadProblemsByName) {
  const auto field = [](auto change) {
    LabelingProblem problem = RandomProblem(2, 2, 3, 1, 1);
    change(problem);
    return DetailOf(MinimizeByExpansion(problem).status()).field;
  };
  EXPECT_EQ(field([](auto& problem) { problem.weight = -1; }), "weight");
  EXPECT_EQ(field([](auto& problem) { problem.candidates[2].clear(); }), "candidates[2]");
  EXPECT_EQ(field([](auto& problem) { problem.candidates[1][0].label = 3; }), "candidates[1]");
  EXPECT_EQ(
      field([](auto& problem) { problem.candidates[1].push_back(problem.candidates[1].front()); }),
      "candidates[1]");
  EXPECT_EQ(field([](auto& problem) {
              problem.candidates[0][0].cost = std::numeric_limits<double>::quiet_NaN();
            }),
            "candidates[0]");
  EXPECT_EQ(field([](auto& problem) { problem.neighbours[1] = {2, 2}; }), "neighbours[1]");
}

}  // namespace
}  // namespace mortise::pareto
