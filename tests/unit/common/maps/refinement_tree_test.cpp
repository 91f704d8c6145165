#include "common/maps/refinement_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "common/base/random.h"

namespace mortise::maps {
namespace {

RefinementTree Tree(int dimension, const RefinementOptions& options = {}) {
  return *RefinementTree::Create(dimension, Basis::kLinear, options);
}

// Splits `splits` times: elements at random, in half of the sequences towards one place of the box.
RefinementTree RandomTree(int dimension, int splits, std::uint64_t seed, int most_disparity = 0) {
  Random random(seed);
  RefinementTree tree = Tree(dimension, {.most_disparity = most_disparity, .most_depth = 12});
  Eigen::VectorXd place(dimension);
  for (int d = 0; d < dimension; ++d) place[d] = random.Uniform();
  for (int n = 0; n < splits; ++n) {
    const std::vector<int> elements = tree.Elements();
    int element = elements[random.Index(elements.size())];
    if (seed % 2 == 0 && random.Uniform() < 0.5) element = tree.Locate(place);
    const int direction = static_cast<int>(random.Index(dimension));
    if (!tree.CanSplit(element, direction)) continue;
    EXPECT_TRUE(tree.Split(element, direction).ok());
  }
  return tree;
}

class Invariants : public testing::TestWithParam<int> {};

TEST_P(Invariants, HoldAfterRandomRefinements) {
  const int dimension = GetParam();
  const int sequences[] = {0, 300, 300, 200, 100, 40, 12};
  const int splits[] = {0, 30, 30, 25, 15, 8, 5};
  for (int seed = 0; seed < sequences[dimension]; ++seed) {
    const RefinementTree tree =
        RandomTree(dimension, 1 + seed % splits[dimension], static_cast<std::uint64_t>(seed));
    const absl::Status status = CheckInvariants(tree);
    ASSERT_TRUE(status.ok()) << "seed " << seed << ": " << status;
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Invariants, testing::Range(1, 7));

}  // namespace
}  // namespace mortise::maps
