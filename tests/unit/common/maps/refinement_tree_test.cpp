#include "common/maps/refinement_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/base/errors.h"
#include "tests/unit/common/maps/random_tree.h"

namespace mortise::maps {
namespace {

using testing::ElementsAre;
using testing::SizeIs;
using testing::UnorderedElementsAre;

RefinementTree Tree(int dimension, const RefinementOptions& options = {}) {
  return *RefinementTree::Create(dimension, Basis::kLinear, options);
}

std::vector<std::vector<double>> Positions(const RefinementTree& tree,
                                           const std::vector<int>& samples) {
  std::vector<std::vector<double>> positions;
  for (const int sample : samples) {
    const Eigen::VectorXd position = tree.SamplePosition(sample);
    positions.emplace_back(position.begin(), position.end());
  }
  return positions;
}

// What the map of these sample values says at a point.
template <typename Function>
double Interpolate(const RefinementTree& tree, const Eigen::VectorXd& point,
                   const Function& function) {
  const PointWeights weights = tree.Weights(point);
  double sum = 0;
  for (std::size_t n = 0; n < weights.samples.size(); ++n) {
    sum += weights.weights[static_cast<Eigen::Index>(n)] *
           function(tree.SamplePosition(weights.samples[n]));
  }
  return sum;
}

class Invariants : public testing::TestWithParam<int> {};
class FaceContinuity : public testing::TestWithParam<int> {};

TEST_P(Invariants, HoldAfterRandomRefinements) {
  const int dimension = GetParam();
  const int sequences[] = {0, 500, 500, 300, 150, 40, 12, 3, 1};
  const int splits[] = {0, 30, 30, 25, 15, 8, 5, 3, 2};
  for (int seed = 0; seed < sequences[dimension]; ++seed) {
    const RefinementTree tree = RandomTree(dimension, Basis::kLinear, 1 + seed % splits[dimension],
                                           static_cast<std::uint64_t>(seed));
    const absl::Status status = CheckInvariants(tree);
    ASSERT_TRUE(status.ok()) << "seed " << seed << ": " << status;
  }
}

TEST_P(FaceContinuity, HoldsAcrossEveryFace) {
  const int dimension = GetParam();
  const int splits[] = {0, 30, 40, 30, 15, 8, 5};
  Random random(3);
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const RefinementTree tree = RandomTree(dimension, Basis::kLinear, splits[dimension], seed);
    for (const int element : tree.Elements()) {
      const ElementBox box = tree.BoxOf(element);
      const int d = static_cast<int>(random.Index(dimension));
      if (box.low[d] == 0) continue;
      Eigen::VectorXd point =
          box.low + (box.high - box.low).cwiseProduct(RandomPoint(dimension, random));
      point[d] = box.low[d];
      Eigen::VectorXd below = point;
      below[d] = std::nextafter(point[d], 0.0);
      const auto rough = [&](const Eigen::VectorXd& x) { return std::sin(1e4 * x.sum()); };
      ASSERT_NEAR(Interpolate(tree, point, rough), Interpolate(tree, below, rough), 1e-11);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Invariants, testing::Range(1, 9));
INSTANTIATE_TEST_SUITE_P(Dimensions, FaceContinuity, testing::Range(1, 7));

TEST(RefinementTree, SamplesTheCornersOfItsElement) {
  const RefinementTree tree = Tree(2);
  EXPECT_THAT(Positions(tree, tree.ElementSamples(0)),
              UnorderedElementsAre(ElementsAre(0, 0), ElementsAre(0, 1), ElementsAre(1, 0),
                                   ElementsAre(1, 1)));
}

// Figure 6-9, left: the split plane ends on the faces of neighbours.
TEST(RefinementTree, AddsTheEndsOfTheSplitInTwoDirections) {
  RefinementTree tree = Tree(2);
  EXPECT_THAT(Positions(tree, *tree.Split(0, 0)),
              UnorderedElementsAre(ElementsAre(.5, 0), ElementsAre(.5, 1)));
  EXPECT_THAT(Positions(tree, *tree.Split(1, 1)),
              UnorderedElementsAre(ElementsAre(0, .5), ElementsAre(.5, .5)));
  // The other half is split at the same height: one of the ends is there already.
  EXPECT_THAT(Positions(tree, *tree.Split(2, 1)), UnorderedElementsAre(ElementsAre(1, .5)));
}

// Figure 6-9, right: where a split meets the edge between two neighbours, both elements' common
// cuboid with each of them ends, although none of them has a corner there.
TEST(RefinementTree, AddsCornersOfCommonCuboidsWithNeighboursInThreeDirections) {
  RefinementTree tree = Tree(3);
  ASSERT_TRUE(tree.Split(0, 0).ok());         // 1: x < 1/2, 2: x > 1/2
  ASSERT_THAT(*tree.Split(1, 1), SizeIs(4));  // the left half along y: edge at (1/2, 1/2, z)
  EXPECT_THAT(
      Positions(tree, *tree.Split(2, 2)),  // the right half along z
      UnorderedElementsAre(ElementsAre(.5, 0, .5), ElementsAre(.5, 1, .5), ElementsAre(1, 0, .5),
                           ElementsAre(1, 1, .5), ElementsAre(.5, .5, .5)));
}

// Neither an element nor two elements' common cuboid has a corner at the middle; three have.
TEST(RefinementTree, AddsCornersOfCommonCuboidsOfThreeElements) {
  RefinementTree tree = Tree(5);
  ASSERT_TRUE(tree.Split(0, 0).ok());  // 1, 2
  ASSERT_TRUE(tree.Split(1, 1).ok());  // 3, 4
  ASSERT_TRUE(tree.Split(3, 2).ok());  // 5, 6
  ASSERT_TRUE(tree.Split(4, 3).ok());  // 7, 8
  EXPECT_THAT(Positions(tree, *tree.Split(2, 4)),
              testing::Contains(ElementsAre(.5, .5, .5, .5, .5)));
  EXPECT_TRUE(CheckInvariants(tree).ok()) << CheckInvariants(tree);
}

// With a level for each direction the B-spline at (0.75, 0.5) would have no local point here.
TEST(RefinementTree, KeepsLocalityWhereALevelForEachDirectionLosesIt) {
  RefinementTree tree = Tree(2);
  ASSERT_TRUE(tree.Split(0, 0).ok());  // 1, 2
  ASSERT_TRUE(tree.Split(1, 1).ok());  // 3, 4
  ASSERT_TRUE(tree.Split(3, 0).ok());
  ASSERT_TRUE(tree.Split(2, 0).ok());
  EXPECT_TRUE(CheckInvariants(tree, 50).ok()) << CheckInvariants(tree, 50);
}

TEST(RefinementTree, IsMultiLinearOnAUniformGrid) {
  RefinementTree tree = Tree(2);
  for (int direction : {0, 1}) {
    for (const int element : tree.Elements()) ASSERT_TRUE(tree.Split(element, direction).ok());
  }
  Random random(5);
  const auto product = [](const Eigen::VectorXd& x) {
    return std::abs(x[0] - .5) * std::abs(x[1] - .5);
  };
  for (int n = 0; n < 100; ++n) {
    const Eigen::VectorXd point = RandomPoint(2, random);
    EXPECT_NEAR(Interpolate(tree, point, product), product(point), 1e-15);
  }
}

// Figure A-2: the left edge of an element has no sample in its middle, the right edge has one. The
// centre of the coarse B-splines' children takes the mean of the corners, the right edge its
// sample.
TEST(RefinementTree, RestrictsASampleToItsLevelAtATJunction) {
  RefinementTree tree = Tree(2);
  ASSERT_TRUE(tree.Split(0, 0).ok());
  ASSERT_TRUE(tree.Split(1, 1).ok());
  ASSERT_TRUE(tree.Split(3, 0).ok());
  ASSERT_TRUE(tree.Split(4, 0).ok());
  const auto hanging = [](const Eigen::VectorXd& x) {
    return x[0] == .5 && x[1] == .5 ? 1.0 : 0.0;
  };
  EXPECT_NEAR(Interpolate(tree, Eigen::Vector2d(.5, .5), hanging), 1, 1e-15);
  EXPECT_NEAR(Interpolate(tree, Eigen::Vector2d(.625, .5), hanging), .75, 1e-15);
  EXPECT_NEAR(Interpolate(tree, Eigen::Vector2d(1, .5), hanging), 0, 1e-15);
}

TEST(RefinementTree, DoesNotDependOnTheOrderOfSplits) {
  RefinementTree first = Tree(2), second = Tree(2);
  for (const auto& [element, direction] : {std::pair{0, 0}, {1, 1}, {2, 0}, {3, 0}}) {
    ASSERT_TRUE(first.Split(element, direction).ok());
  }
  // The same elements; 5 and 6 are the other way round.
  for (const auto& [element, direction] : {std::pair{0, 0}, {2, 0}, {1, 1}, {5, 0}}) {
    ASSERT_TRUE(second.Split(element, direction).ok());
  }
  const auto rough = [](const Eigen::VectorXd& x) {
    return std::sin(1e4 * x[0]) + std::cos(1e4 * x[1]);
  };
  Random random(9);
  for (int n = 0; n < 200; ++n) {
    const Eigen::VectorXd point = RandomPoint(2, random);
    EXPECT_NEAR(Interpolate(first, point, rough), Interpolate(second, point, rough), 1e-14);
  }
}

TEST(RefinementTree, ReplaysItsHistoryBitForBit) {
  const RefinementTree tree = RandomTree(3, Basis::kLinear, 30, 4);
  const auto again = RefinementTree::Replay(3, Basis::kLinear, tree.options(), tree.history());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->history(), tree.history());
  EXPECT_EQ(again->Elements(), tree.Elements());
  Random random(2);
  for (int n = 0; n < 100; ++n) {
    const Eigen::VectorXd point = RandomPoint(3, random);
    EXPECT_EQ(again->Weights(point).samples, tree.Weights(point).samples);
    EXPECT_EQ(again->Weights(point).weights, tree.Weights(point).weights);
  }
}

TEST(RefinementTree, BoundsDisparityBySplittingAlongOtherDirectionsFirst) {
  RefinementTree tree = Tree(3, {.most_disparity = 2});
  for (int n = 0; n < 6; ++n) {
    ASSERT_TRUE(tree.Split(tree.Locate(Eigen::Vector3d(.3, .3, .3)), 1).ok());
  }
  for (const int element : tree.Elements()) {
    const auto [least, most] =
        std::minmax({tree.DepthOf(element, 0), tree.DepthOf(element, 1), tree.DepthOf(element, 2)});
    EXPECT_LE(most - least, 2);
  }
  EXPECT_EQ(tree.DepthOf(tree.Locate(Eigen::Vector3d(.3, .3, .3)), 1), 6);
  EXPECT_TRUE(CheckInvariants(tree).ok()) << CheckInvariants(tree);
}

TEST(RefinementTree, HasDerivativesOfWhatItInterpolates) {
  const RefinementTree tree = RandomTree(3, Basis::kLinear, 25, 8);
  Random random(6);
  for (int n = 0; n < 100; ++n) {
    const Eigen::VectorXd point = RandomPoint(3, random);
    const PointWeights weights = tree.Weights(point);
    const auto rough = [](const Eigen::VectorXd& x) { return std::sin(1e4 * x.sum()); };
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3);
    for (std::size_t k = 0; k < weights.samples.size(); ++k) {
      gradient += weights.gradients.col(static_cast<Eigen::Index>(k)) *
                  rough(tree.SamplePosition(weights.samples[k]));
    }
    for (int d = 0; d < 3; ++d) {
      // It is linear along an edge, so that differences are exact but for rounding.
      const double step = 1e-6;
      Eigen::VectorXd ahead = point;
      ahead[d] += step;
      EXPECT_NEAR((Interpolate(tree, ahead, rough) - Interpolate(tree, point, rough)) / step,
                  gradient[d], 1e-6 * (1 + std::abs(gradient[d])));
    }
  }
}

// Sliders stand at round numbers, which are faces of elements and centres of B-splines.
TEST(RefinementTree, HasDerivativesOfTheUpperSideOnFacesAndOfTheLowerOneAtTheEnd) {
  const RefinementTree tree = RandomTree(3, Basis::kLinear, 25, 8);
  const auto rough = [](const Eigen::VectorXd& x) { return std::sin(1e4 * x.sum()); };
  Random random(6);
  for (int n = 0; n < 200; ++n) {
    Eigen::VectorXd point = RandomPoint(3, random);
    for (int d = 0; d < 3; ++d) {
      if (n % 4 != d) point[d] = std::round(8 * point[d]) / 8;
    }
    const PointWeights weights = tree.Weights(point);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3);
    for (std::size_t k = 0; k < weights.samples.size(); ++k) {
      gradient += weights.gradients.col(static_cast<Eigen::Index>(k)) *
                  rough(tree.SamplePosition(weights.samples[k]));
    }
    for (int d = 0; d < 3; ++d) {
      const double step = point[d] < 1 ? 1e-6 : -1e-6;
      Eigen::VectorXd beside = point;
      beside[d] += step;
      EXPECT_NEAR((Interpolate(tree, beside, rough) - Interpolate(tree, point, rough)) / step,
                  gradient[d], 1e-6 * (1 + std::abs(gradient[d])))
          << point.transpose();
    }
  }
}

TEST(RefinementTree, RefusesWhatItCannotDo) {
  const auto field = [](const absl::Status& status) { return DetailOf(status).field; };
  EXPECT_EQ(field(RefinementTree::Create(0, Basis::kLinear).status()), "dimension");
  EXPECT_EQ(field(RefinementTree::Create(11, Basis::kLinear).status()), "dimension");
  EXPECT_EQ(field(RefinementTree::Create(2, Basis::kLinear, {.most_depth = 23}).status()),
            "options.most_depth");
  EXPECT_EQ(field(RefinementTree::Create(2, Basis::kLinear, {.most_disparity = -1}).status()),
            "options.most_disparity");
  RefinementTree tree = Tree(2, {.most_depth = 1});
  EXPECT_EQ(field(tree.Split(1, 0).status()), "element");
  EXPECT_EQ(field(tree.Split(0, 2).status()), "direction");
  ASSERT_TRUE(tree.Split(0, 0).ok());
  EXPECT_EQ(field(tree.Split(0, 0).status()), "element");
  EXPECT_EQ(field(tree.Split(1, 0).status()), "direction");
  const ElementSplit wrong[] = {{0, 0}, {0, 1}};
  EXPECT_EQ(field(RefinementTree::Replay(2, Basis::kLinear, {}, wrong).status()), "splits[1]");
}

}  // namespace
}  // namespace mortise::maps
