// Trees that were split at random, for the tests of maps.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "common/base/random.h"
#include "common/maps/refinement_tree.h"

namespace mortise::maps {

inline Eigen::VectorXd RandomPoint(int dimension, Random& random) {
  Eigen::VectorXd point(dimension);
  for (double& coordinate : point) coordinate = random.Uniform();
  return point;
}

// Splits `splits` times: elements at random, for even seeds half of the time towards one place.
inline RefinementTree RandomTree(int dimension, Basis basis, int splits, std::uint64_t seed) {
  Random random(seed);
  RefinementTree tree = *RefinementTree::Create(dimension, basis, {.most_depth = 12});
  const Eigen::VectorXd place = RandomPoint(dimension, random);
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

}  // namespace mortise::maps
