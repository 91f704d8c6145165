// Combinations of discrete values, and what is learnt of them.
#include "services/pareto/models/combinations.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

#include "common/base/errors.h"
#include "services/pareto/models/combination_model.h"

namespace mortise::pareto {
namespace {

using Eigen::Vector4d;
using Eigen::VectorXd;

// A length, a choice of 3, a count of 2 to 5, and a count of 0 to 40.
DesignSpace LengthAndCounts() {
  return {Vector4d(0, 0, 2, 0), Vector4d(1, 2, 5, 40), Vector4d(0, 1, 1, 1)};
}

TEST(Combinations, TakeWholeNumbersOfFewValuesWhereTheBudgetAllows) {
  const std::vector<DiscreteParameter> choice = {{1, {0, 1, 2}}};
  const auto with = WithWholeNumbers(LengthAndCounts(), choice, 1000);
  ASSERT_EQ(with.size(), 2u) << "41 values are too many";
  EXPECT_EQ(with[1].parameter, 2);
  EXPECT_EQ(with[1].values, (std::vector<double>{2, 3, 4, 5}));
  EXPECT_EQ(WithWholeNumbers(LengthAndCounts(), choice, 200).size(), 1u)
      << "12 combinations are too many";
  DesignSpace halves = LengthAndCounts();
  halves.step[2] = 0.5;
  EXPECT_EQ(WithWholeNumbers(halves, choice, 1000).size(), 1u) << "no whole number";
}

TEST(Combinations, AreAllDesignsWhereThoseAreFew) {
  DesignSpace space = LengthAndCounts();
  space.upper[0] = 0;
  EXPECT_EQ(WithWholeNumbers(space, {{1, {0, 1, 2}}}, 492).size(), 3u) << "3 * 4 * 41 designs";
  EXPECT_EQ(WithWholeNumbers(space, {{1, {0, 1, 2}}}, 491).size(), 2u);
}

TEST(Combinations, AreCountedInOrder) {
  const CombinationSpace space(LengthAndCounts(), {{1, {0, 2}}, {2, {2, 3, 5}}});
  ASSERT_EQ(space.count(), 6);
  std::set<Combination> all;
  for (int k = 0; k < 6; ++k) all.insert(space.At(k));
  EXPECT_EQ(all.size(), 6u);
  const DesignSpace last = space.SpaceOf(space.At(5));
  EXPECT_EQ(last.lower, Vector4d(0, 2, 5, 0));
  EXPECT_EQ(last.upper, Vector4d(1, 2, 5, 40));
  EXPECT_EQ(space.Neighbours({0, 1}).size(), 3u);
}

std::vector<DiscreteParameter> OfEight(Eigen::Index count) {
  std::vector<DiscreteParameter> discrete;
  for (Eigen::Index i = 0; i < count; ++i) discrete.push_back({i, {0, 1, 2, 3, 4, 5, 6, 7}});
  return discrete;
}

TEST(Combinations, FillTheSpaceEvenly) {
  const CombinationSpace space({VectorXd::Zero(4), VectorXd::Constant(4, 7)}, OfEight(4));
  Random random(3);
  const std::vector<Combination> some = space.SpaceFilling(24, random);
  EXPECT_EQ(std::set<Combination>(some.begin(), some.end()).size(), 24u);
  for (std::size_t k = 0; k < 4; ++k) {
    std::map<int, int> uses;
    for (const Combination& combination : some) ++uses[combination[k]];
    EXPECT_EQ(uses.size(), 8u);
    for (const auto& [value, count] : uses) EXPECT_NEAR(count, 3, 1);
  }
  EXPECT_EQ(space.SpaceFilling(5000, random).size(), 4096u);
}

TEST(Combinations, MayBeMoreThanCanBeCounted) {
  const CombinationSpace space({VectorXd::Zero(30), VectorXd::Constant(30, 7)}, OfEight(30));
  EXPECT_EQ(space.count(), std::int64_t{1} << 56);
  Random random(1);
  EXPECT_EQ(space.SpaceFilling(10, random).size(), 10u);
  EXPECT_EQ(space.At(space.count() - 1).size(), 30u);
}

TEST(Combinations, NameWhatIsWrongWithThem) {
  const auto field = [](const std::vector<DiscreteParameter>& discrete) {
    return DetailOf(Validate(discrete, LengthAndCounts())).field;
  };
  EXPECT_TRUE(Validate({{1, {0, 2}}}, LengthAndCounts()).ok());
  EXPECT_EQ(field({{4, {0}}}), "discrete[0].parameter");
  EXPECT_EQ(field({{1, {0}}, {1, {1}}}), "discrete[1].parameter");
  EXPECT_EQ(field({{1, {}}}), "discrete[0].values");
  EXPECT_EQ(field({{1, {1, 0}}}), "discrete[0].values");
  EXPECT_EQ(field({{1, {0, 3}}}), "discrete[0].values");
  EXPECT_EQ(field({{1, {std::numeric_limits<double>::quiet_NaN()}}}), "discrete[0].values");
}

TEST(CombinationModel, LearnsWhatEachValueAdds) {
  const std::vector<DiscreteParameter> discrete = {{0, {0, 1, 2}}, {1, {0, 1}}};
  const CombinationSpace space({VectorXd::Zero(3), Eigen::Vector3d(2, 1, 1)}, discrete);
  const double first[] = {0.3, 0, 1.2}, second[] = {0, -0.5};
  std::vector<Combination> combinations;
  for (int k = 0; k < 6; ++k) combinations.push_back(space.At(k));
  std::vector<CombinationModel::Sample> samples;
  Random random(5);
  for (std::size_t i = 0; i < 120; ++i) {
    const Combination& combination = combinations[i % 6];
    const double u = random.Uniform();
    const double value = first[combination[0]] + second[combination[1]] + u * u;
    samples.push_back({&combination, VectorXd::Constant(1, u), Eigen::Vector2d(value, -value)});
  }
  const CombinationModel model(discrete, samples);
  const VectorXd change = model.Difference({0, 0}, {2, 1});
  EXPECT_NEAR(change[0], 0.4, 0.02);
  EXPECT_NEAR(change[1], -0.4, 0.02);
  EXPECT_EQ(model.Difference({1, 1}, {1, 1}).norm(), 0);
}

}  // namespace
}  // namespace mortise::pareto
