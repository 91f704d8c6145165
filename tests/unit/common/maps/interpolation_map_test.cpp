#include "common/maps/interpolation_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/common/maps/random_tree.h"

namespace mortise::maps {
namespace {

// A map of two outputs whose samples are rough, so that nothing is right by chance.
MapContent RoughContent(int dimension, Basis basis, int splits, std::uint64_t seed) {
  const RefinementTree tree = RandomTree(dimension, basis, splits, seed);
  MapContent content{
      .dimension = dimension, .basis = basis, .options = tree.options(), .splits = tree.history()};
  content.values.resize(2, tree.sample_count());
  for (int sample = 0; sample < tree.sample_count(); ++sample) {
    const double at = tree.SamplePosition(sample).sum();
    content.values.col(sample) << std::sin(1e4 * at), 3 + std::cos(1e4 * at);
  }
  content.errors = Eigen::MatrixXd::Constant(2, tree.element_count(), .25);
  content.cut_off.assign(tree.element_count(), 0);
  return content;
}

class InterpolationMapOf : public testing::TestWithParam<int> {};

TEST_P(InterpolationMapOf, SaysWhatTheTreeSays) {
  const int dimension = GetParam();
  const MapContent content = RoughContent(dimension, Basis::kLinear, dimension < 5 ? 25 : 6, 4);
  const auto map = InterpolationMap::Create(content);
  ASSERT_TRUE(map.ok()) << map.status();
  Random random(3);
  for (int n = 0; n < 60; ++n) {
    Eigen::VectorXd point = RandomPoint(dimension, random);
    // Some on faces of elements and of the box.
    if (n % 3 == 0) point = (4 * point).array().round() / 4;
    const PointWeights weights = map->tree().Weights(point);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(2);
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(dimension, 2);
    for (std::size_t k = 0; k < weights.samples.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const Eigen::VectorXd value = content.values.col(weights.samples[k]);
      expected += weights.weights[column] * value;
      slopes += weights.gradients.col(column) * value.transpose();
    }
    const MapValues values = map->Evaluate(point, true);
    EXPECT_LT((values.values - expected).cwiseAbs().maxCoeff(), 1e-12);
    const Eigen::VectorXd flat = Eigen::Map<const Eigen::VectorXd>(slopes.data(), slopes.size());
    EXPECT_LT((values.gradients - flat).cwiseAbs().maxCoeff(),
              1e-9 * (1 + flat.cwiseAbs().maxCoeff()));
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, InterpolationMapOf, testing::Range(1, 7));

TEST(InterpolationMap, EvaluatesManyPointsAsOneAfterTheOther) {
  const auto map = *InterpolationMap::Create(RoughContent(3, Basis::kLinear, 30, 2));
  Eigen::MatrixXd points(3, 50);
  Random random(8);
  for (int n = 0; n < 50; ++n) points.col(n) = RandomPoint(3, random);
  const MapValues together = map.Evaluate(points, true);
  for (int n = 0; n < 50; ++n) {
    const MapValues alone = map.Evaluate(points.col(n), true);
    EXPECT_EQ(alone.values, together.values.col(n));
    EXPECT_EQ(alone.errors, together.errors.col(n));
    EXPECT_EQ(alone.gradients, together.gradients.col(n));
  }
}

TEST(InterpolationMap, TakesPointsOutsideToTheFaces) {
  const auto map = *InterpolationMap::Create(RoughContent(2, Basis::kLinear, 12, 2));
  EXPECT_EQ(map.Evaluate(Eigen::Vector2d(-3, .4)).values,
            map.Evaluate(Eigen::Vector2d(0, .4)).values);
  EXPECT_EQ(map.Evaluate(Eigen::Vector2d(.2, 1.5)).values,
            map.Evaluate(Eigen::Vector2d(.2, 1)).values);
}

TEST(InterpolationMap, HasNoValueWhereItIsCutOffOrThePointIsNone) {
  MapContent content = RoughContent(1, Basis::kLinear, 0, 2);
  content.options = RefinementTree::Create(1, Basis::kLinear)->options();
  content.splits = {{0, 0}};
  content.values = Eigen::MatrixXd::Ones(2, 3);
  content.errors = Eigen::MatrixXd::Zero(2, 2);
  content.cut_off = {0, 1};
  const auto map = *InterpolationMap::Create(content);
  EXPECT_EQ(map.Evaluate(Eigen::VectorXd::Constant(1, .2)).values(1), 1);
  const MapValues none = map.Evaluate(Eigen::VectorXd::Constant(1, .8), true);
  EXPECT_TRUE(none.values.array().isNaN().all());
  EXPECT_TRUE(none.gradients.array().isNaN().all());
  EXPECT_TRUE(std::isinf(none.errors(0)));
  const double not_finite = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(map.Evaluate(Eigen::VectorXd::Constant(1, not_finite)).values.array().isNaN().all());
}

TEST(InterpolationMap, RefusesWhatIsNoMap) {
  const MapContent good = RoughContent(2, Basis::kLinear, 5, 1);
  ASSERT_TRUE(InterpolationMap::Create(good).ok());
  const auto field_after = [&](const auto& spoil) {
    MapContent content = good;
    spoil(content);
    return DetailOf(InterpolationMap::Create(content).status()).field;
  };
  EXPECT_EQ(field_after([](MapContent& c) { c.dimension = 0; }), "dimension");
  EXPECT_EQ(field_after([](MapContent& c) { c.splits.push_back({0, 0}); }), "splits[5]");
  EXPECT_EQ(field_after([](MapContent& c) { c.splits.pop_back(); }), "values");
  EXPECT_EQ(field_after([](MapContent& c) { c.values(0, 0) = 1 / 0.0; }), "values");
  EXPECT_EQ(field_after([](MapContent& c) { c.values.resize(0, c.values.cols()); }), "values");
  EXPECT_EQ(field_after([](MapContent& c) { c.errors.resize(1, c.errors.cols()); }), "errors");
  EXPECT_EQ(field_after([](MapContent& c) { c.cut_off.clear(); }), "cut_off");
}

// Unity, linear precision, locality within four steps, and C² of the cubic basis.
class CubicMapOf : public testing::TestWithParam<int> {
 protected:
  static constexpr int kSplits[] = {0, 20, 25, 8};
};

TEST_P(CubicMapOf, ReproducesLinearFunctions) {
  const int dimension = GetParam();
  for (std::uint64_t seed = 0; seed < (dimension < 3 ? 8U : 2U); ++seed) {
    MapContent content = RoughContent(dimension, Basis::kCubic, kSplits[dimension], seed);
    const RefinementTree tree =
        *RefinementTree::Replay(dimension, Basis::kCubic, content.options, content.splits);
    ASSERT_TRUE(CheckInvariants(tree).ok()) << CheckInvariants(tree);
    Random random(seed);
    const Eigen::VectorXd slope = 2 * RandomPoint(dimension, random);
    for (int sample = 0; sample < tree.sample_count(); ++sample) {
      content.values.col(sample) << 1, slope.dot(tree.SamplePosition(sample)) - 3;
    }
    const auto map = *InterpolationMap::Create(content);
    for (int n = 0; n < 100; ++n) {
      const Eigen::VectorXd point = RandomPoint(dimension, random);
      const MapValues values = map.Evaluate(point, true);
      EXPECT_NEAR(values.values(0), 1, 1e-11);
      EXPECT_NEAR(values.values(1), slope.dot(point) - 3, 1e-11);
      EXPECT_LT((values.gradients.bottomRows(dimension) - slope).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

TEST_P(CubicMapOf, LetsASampleActNearItOnly) {
  const int dimension = GetParam();
  MapContent content =
      RoughContent(dimension, Basis::kCubic, std::array{0, 40, 60, 25}[dimension], 2);
  const auto before = *InterpolationMap::Create(content);
  const RefinementTree& tree = before.tree();
  Random random(1);
  for (int n = 0; n < 3; ++n) {
    const int sample = static_cast<int>(random.Index(tree.sample_count()));
    std::set<int> near;
    for (const int element : tree.SampleElements(sample)) near.insert(element);
    for (int step = 0; step < 4; ++step) {
      for (const int element : std::set<int>(near)) {
        for (const int next : tree.Neighbours(element)) near.insert(next);
      }
    }
    MapContent changed = content;
    changed.values(0, sample) += 10;
    const auto after = *InterpolationMap::Create(changed);
    for (int k = 0; k < 200; ++k) {
      const Eigen::VectorXd point = RandomPoint(dimension, random);
      if (near.contains(tree.Locate(point))) continue;
      EXPECT_EQ(before.Evaluate(point).values, after.Evaluate(point).values);
    }
  }
}

TEST_P(CubicMapOf, IsTwiceContinuouslyDifferentiable) {
  const int dimension = GetParam();
  const auto map =
      *InterpolationMap::Create(RoughContent(dimension, Basis::kCubic, kSplits[dimension], 6));
  Random random(5);
  for (const int element : map.tree().Elements()) {
    const ElementBox box = map.tree().BoxOf(element);
    const int d = static_cast<int>(random.Index(dimension));
    if (box.low[d] == 0) continue;
    Eigen::VectorXd point =
        box.low + (box.high - box.low).cwiseProduct(RandomPoint(dimension, random));
    const auto gradient_at = [&](double offset) {
      point[d] = box.low[d] + offset;
      return Eigen::MatrixXd(map.Evaluate(point, true).gradients);
    };
    // The difference of the second derivatives on both sides goes to zero with the distance.
    const auto difference_at = [&](double step) {
      const Eigen::MatrixXd here = gradient_at(0);
      return Eigen::MatrixXd((gradient_at(step) - here) / step - (here - gradient_at(-step)) / step)
          .cwiseAbs()
          .maxCoeff();
    };
    const double edge = (box.high - box.low).minCoeff();
    const double step = 1e-4 * edge;
    EXPECT_LT(difference_at(step), difference_at(8 * step) / 4 + 1e-5 / (edge * edge));
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, CubicMapOf, testing::Range(1, 4));

// On a smooth function it is more exact than the linear map of the same samples.
TEST(CubicMap, IsMoreExactThanTheLinearOneWhereTheFunctionIsSmooth) {
  const auto smooth = [](const Eigen::VectorXd& x) { return std::sin(3 * x[0] + 2 * x[1]); };
  double largest[2] = {0, 0};
  for (const Basis basis : {Basis::kLinear, Basis::kCubic}) {
    RefinementTree tree = *RefinementTree::Create(2, basis);
    for (int round = 0; round < 8; ++round) {
      for (const int element : tree.Elements()) ASSERT_TRUE(tree.Split(element, round % 2).ok());
    }
    MapContent content{
        .dimension = 2, .basis = basis, .options = tree.options(), .splits = tree.history()};
    content.values.resize(1, tree.sample_count());
    for (int sample = 0; sample < tree.sample_count(); ++sample) {
      content.values(0, sample) = smooth(tree.SamplePosition(sample));
    }
    content.errors = Eigen::MatrixXd::Zero(1, tree.element_count());
    content.cut_off.assign(tree.element_count(), 0);
    const auto map = *InterpolationMap::Create(content);
    Random random(3);
    for (int n = 0; n < 500; ++n) {
      const Eigen::VectorXd point = RandomPoint(2, random);
      double& error = largest[basis == Basis::kCubic ? 1 : 0];
      error = std::max(error, std::abs(map.Evaluate(point).values(0) - smooth(point)));
    }
  }
  EXPECT_LT(largest[1], largest[0] / 10);
}

}  // namespace
}  // namespace mortise::maps
