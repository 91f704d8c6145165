// Positions of trade-offs, and back.
#include "services/pareto/archive/embedding.h"

#include <gtest/gtest.h>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

TEST(Embedding, IsWithinTheUnitCubeAndKeepsTheRay) {
  Random random(2);
  for (const Eigen::Index d : {2, 3, 4, 6}) {
    for (int i = 0; i < 50; ++i) {
      const VectorXd y = 3 * random.Uniform() * random.UnitVector(d).cwiseAbs();
      const VectorXd embedding = Embed(y);
      ASSERT_EQ(embedding.size(), d - 1);
      EXPECT_GE(embedding.minCoeff(), 0);
      EXPECT_LE(embedding.maxCoeff(), 1);
      EXPECT_LT((RaysAt(embedding) - y.normalized()).norm(), 1e-12);
    }
  }
}

TEST(Embedding, OfTheBestOfEachMetricIsAFace) {
  // The best of the first metric is as far as possible from its axis.
  EXPECT_DOUBLE_EQ(Embed(Eigen::Vector3d(0, 0.4, 0.3))[0], 1);
  EXPECT_DOUBLE_EQ(Embed(Eigen::Vector3d(0.7, 0, 0.3))[1], 1);
  EXPECT_DOUBLE_EQ(Embed(Eigen::Vector3d(0.7, 0.3, 0))[1], 0);
  EXPECT_EQ(Embed(Eigen::Vector2d(-0.1, 0.5)), Embed(Eigen::Vector2d(0, 0.5)));
}

}  // namespace
}  // namespace mortise::pareto
