#include "common/maps/packed_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/common/maps/random_tree.h"

namespace mortise::maps {
namespace {

class SameWeights : public testing::TestWithParam<int> {};

TEST_P(SameWeights, AsOfTheTree) {
  const int dimension = GetParam();
  const int splits[] = {0, 20, 30, 30, 15, 8, 5};
  Random random(5);
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const RefinementTree tree = RandomTree(dimension, Basis::kLinear, splits[dimension], seed);
    const PackedWeights packed(tree);
    std::vector<SampleWeight> weights;
    for (int n = 0; n < 50; ++n) {
      Eigen::VectorXd point = RandomPoint(dimension, random);
      // Corners and faces of elements, too.
      if (n % 3 == 0) point = (point * 8).array().round() / 8;
      const PointWeights expected = tree.Weights(point);
      EXPECT_EQ(packed.At(point.data(), weights), tree.Locate(point));
      std::size_t at = 0;
      for (std::size_t k = 0; k < expected.samples.size(); ++k) {
        const double weight = expected.weights[static_cast<Eigen::Index>(k)];
        if (at < weights.size() && weights[at].sample == expected.samples[k]) {
          ASSERT_NEAR(weights[at++].weight, weight, 1e-14);
        } else {
          ASSERT_NEAR(weight, 0, 1e-14);
        }
      }
      EXPECT_EQ(at, weights.size());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, SameWeights, testing::Range(1, 7));

TEST(PackedWeights, TakesPointsOutsideToTheBox) {
  const RefinementTree tree = RandomTree(2, Basis::kLinear, 10, 1);
  const PackedWeights packed(tree);
  std::vector<SampleWeight> weights;
  const double corner[] = {7.0, -std::numeric_limits<double>::infinity()};
  packed.At(corner, weights);
  ASSERT_EQ(weights.size(), 1U);
  EXPECT_EQ(tree.SamplePosition(weights[0].sample), Eigen::VectorXd(Eigen::Vector2d(1, 0)));
  const double nowhere[] = {std::nan(""), 0.0};
  packed.At(nowhere, weights);
  ASSERT_EQ(weights.size(), 1U);
  EXPECT_EQ(weights[0].weight, 1);
}

}  // namespace
}  // namespace mortise::maps
