// Local optimisation against problems with known answers, bounds, and the quadratic sub-problem.
#include "services/pareto/sources/local_optimization.h"

#include <gtest/gtest.h>

#include "common/base/random.h"
#include "services/pareto/models/bounded_quadratic.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Two paraboloids with minima at 0.2 and 0.8 on the first axis; the front is the segment between.
VectorXd Paraboloids(const VectorXd& u) {
  VectorXd a = VectorXd::Constant(u.size(), 0.5), b = a;
  a[0] = 0.2;
  b[0] = 0.8;
  return Eigen::Vector2d((u - a).squaredNorm(), (u - b).squaredNorm());
}

TEST(BoundedQuadraticTest, MeetsTheOptimalityConditionsAndTheBoundsExactly) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    const Eigen::Index n = 1 + static_cast<Eigen::Index>(random.Index(12));
    MatrixXd A(n, n);
    for (double& value : A.reshaped()) value = 2 * random.Uniform() - 1;
    const MatrixXd B = A.transpose() * A + 1e-3 * MatrixXd::Identity(n, n);
    const VectorXd g = 3 * random.UnitVector(n);
    const VectorXd lower = VectorXd::Constant(n, -0.2), upper = VectorXd::Constant(n, 0.3);
    const VectorXd p = MinimizeBoundedQuadratic(g, B, lower, upper);
    EXPECT_TRUE((p.array() >= lower.array()).all() && (p.array() <= upper.array()).all());
    const VectorXd gradient = g + B * p;
    // A projected gradient step goes nowhere.
    EXPECT_LT(((p - gradient).cwiseMax(lower).cwiseMin(upper) - p).norm(), 1e-4) << round;
  }
}

TEST(BoundedQuadraticTest, GoesToTheEdgeAlongNegativeCurvature) {
  const VectorXd p = MinimizeBoundedQuadratic(Eigen::Vector2d(-0.1, 1),
                                              Eigen::Vector2d(-1, 1).asDiagonal().toDenseMatrix(),
                                              VectorXd::Constant(2, -1), VectorXd::Constant(2, 1));
  EXPECT_DOUBLE_EQ(p[0], 1);
  EXPECT_NEAR(p[1], -1, 1e-9);
}

TEST(LocalOptimizationTest, ReachesTheFrontWithoutGradients) {
  constexpr Eigen::Index D = 5;
  Archive archive;
  LocalOptimization::Options options;
  options.differences = true;
  options.tolerance = 1e-5;
  const Scaling scaling{VectorXd::Zero(2), VectorXd::Ones(2)};
  const LocalOptimization::Target target{VectorXd::Constant(2, -0.1),
                                         VectorXd::Constant(2, -std::sqrt(0.5)), 0.1};
  LocalOptimization search(options, scaling, target, VectorXd::Constant(D, 0.9));
  int evaluations = 0;
  while (!search.Finished()) {
    const auto u = search.Ask(archive);
    if (!u) continue;
    EXPECT_GE(u->minCoeff(), 0);
    EXPECT_LE(u->maxCoeff(), 1);
    ++evaluations;
    search.Tell(archive, archive.Add({*u, true, Paraboloids(*u), {}, {}}));
  }
  const VectorXd best = archive[*search.best()].u;
  // By symmetry of the target the answer is the middle of the segment.
  EXPECT_LT((best - VectorXd::Constant(D, 0.5)).norm(), 0.03);
  EXPECT_LE(evaluations, 40);
}

TEST(LocalOptimizationTest, EndsWhenItsStartFails) {
  Archive archive;
  const Scaling scaling{VectorXd::Zero(2), VectorXd::Ones(2)};
  LocalOptimization search({}, scaling, {VectorXd::Zero(2), -VectorXd::Ones(2), 0.1},
                           VectorXd::Constant(3, 0.5));
  const auto u = search.Ask(archive);
  ASSERT_TRUE(u);
  search.Tell(archive, archive.Add({*u, false, {}, {}, {}}));
  EXPECT_TRUE(search.Finished());
  EXPECT_EQ(search.stop_reason(), LocalOptimization::StopReason::kStartFailed);
  EXPECT_FALSE(search.best());
}

}  // namespace
}  // namespace mortise::pareto
