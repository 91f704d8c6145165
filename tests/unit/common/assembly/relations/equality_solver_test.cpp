// Equalities solved at once and group by group: the same space, and as many independent ones.
#include "common/assembly/relations/equality_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mortise::parametric {
namespace {

Relationship Equality(std::vector<LinearTerm> terms, int group) {
  Relationship made;
  made.form.terms = std::move(terms);
  made.group = group;
  return made;
}

// A hierarchy of `groups` below the root, each below a random one before it, with 40 variables
// each. In a group chains of them are equal, some in proportion, some said twice; each group is
// tied to the one above.
struct RandomEqualities {
  RandomEqualities(int groups, int seed) {
    std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
    const auto below = [&](int count) { return static_cast<int>(random() % count); };
    parents = {-1};
    for (int group = 0; group < groups; ++group) {
      if (group > 0) parents.push_back(below(group));
      const int first = 40 * group;
      for (int i = 0; i < 40; ++i) variables.push_back(first + i);
      for (int i = 0; i < 45; ++i) {
        const int a = first + below(39), b = a + 1;
        const double share = i % 5 == 0 ? 0.5 : 1;
        relationships.push_back(Equality({{a, 1}, {b, -share}}, group));
        if (i % 7 == 0) relationships.push_back(Equality({{a, 3}, {b, -3 * share}}, group));
      }
      for (int i = 0; group > 0 && i < 6; ++i) {
        const int above = 40 * parents.back() + below(40);
        relationships.push_back(Equality(
            {{above, 1}, {first + below(20), -1}, {first + 20 + below(20), -0.5}}, parents.back()));
      }
    }
    for (Relationship& one : relationships) {
      std::sort(one.form.terms.begin(), one.form.terms.end(),
                [](const auto& a, const auto& b) { return a.variable < b.variable; });
    }
  }

  Eigen::MatrixXd DirectionsOf(const SolvedEqualities& solved) const {
    Eigen::Index degrees = 0;
    for (const FreeVariables& free : solved.free) degrees += free.directions.cols();
    Eigen::MatrixXd basis =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(variables.size()), degrees);
    Eigen::Index column = 0;
    for (const FreeVariables& free : solved.free) {
      for (std::size_t i = 0; i < free.variables.size(); ++i) {
        basis.row(free.variables[i]).segment(column, free.directions.cols()) =
            free.directions.row(static_cast<Eigen::Index>(i));
      }
      column += free.directions.cols();
    }
    return basis;
  }

  std::vector<int> parents;
  std::vector<int> variables;
  std::vector<Relationship> relationships;
};

class EqualitySolverTest : public ::testing::TestWithParam<int> {};

TEST_P(EqualitySolverTest, GroupByGroupLeavesTheSameFree) {
  const RandomEqualities random(30, GetParam());
  EqualitySolver solver;
  const SolvedEqualities at_once =
      SolveEqualities(random.relationships, random.variables, {}, solver);
  const SolvedEqualities by_groups =
      SolveEqualities(random.relationships, random.variables, random.parents, solver);
  EXPECT_EQ(by_groups.kept.size(), at_once.kept.size());
  const Eigen::MatrixXd a = random.DirectionsOf(at_once), b = random.DirectionsOf(by_groups);
  ASSERT_EQ(a.cols(), b.cols());
  ASSERT_GT(a.cols(), 0);
  EXPECT_LT((b.transpose() * b - Eigen::MatrixXd::Identity(b.cols(), b.cols())).norm(), 1e-11);
  EXPECT_LT((b - a * (a.transpose() * b)).norm(), 1e-10);
  for (const Relationship& relationship : random.relationships) {
    Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(b.cols());
    for (const LinearTerm& term : relationship.form.terms) {
      change += term.coefficient * b.row(term.variable);
    }
    EXPECT_LT(change.norm(), 1e-11);
  }
  // What is kept implies all the rest.
  std::vector<Relationship> kept;
  for (const Relationship* one : by_groups.kept) kept.push_back(*one);
  const SolvedEqualities again = SolveEqualities(kept, random.variables, {}, solver);
  EXPECT_EQ(again.kept.size(), kept.size());
  EXPECT_EQ(random.DirectionsOf(again).cols(), b.cols());
}

TEST_P(EqualitySolverTest, WhatIsKnownIsWhatSolvingGives) {
  RandomEqualities random(30, GetParam());
  EqualitySolver first;
  const auto solve = [&](EqualitySolver& solver) {
    return random.DirectionsOf(
        SolveEqualities(random.relationships, random.variables, random.parents, solver));
  };
  const Eigen::MatrixXd directions = solve(first);
  EqualitySolver knowing({first.solved(), nullptr});
  EXPECT_EQ(solve(knowing), directions);
  // Another tie in the root: all below it is known.
  random.relationships.push_back(Equality({{0, 1}, {39, -1}}, 0));
  EqualitySolver anew;
  EqualitySolver half_knowing({first.solved()});
  EXPECT_EQ(solve(half_knowing), solve(anew));
  EXPECT_EQ(half_knowing.solved()->MemoryUse(), anew.solved()->MemoryUse());
}

INSTANTIATE_TEST_SUITE_P(Random, EqualitySolverTest, ::testing::Range(1, 9));

TEST(EqualitySolverTest, VariablesOfNoEqualityAreFree) {
  EqualitySolver solver;
  const SolvedEqualities solved =
      SolveEqualities({Equality({{0, 1}, {2, -1}}, 0)}, {0, 1, 2, 3}, {-1}, solver);
  std::set<int> free;
  Eigen::Index degrees = 0;
  for (const FreeVariables& part : solved.free) {
    free.insert(part.variables.begin(), part.variables.end());
    degrees += part.directions.cols();
  }
  EXPECT_EQ(free, (std::set<int>{0, 1, 2, 3}));
  EXPECT_EQ(degrees, 3);
  EXPECT_EQ(solved.kept.size(), 1U);
}

}  // namespace
}  // namespace mortise::parametric
