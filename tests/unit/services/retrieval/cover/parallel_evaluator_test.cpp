// Evaluations on several threads, and their faults.
#include "services/retrieval/cover/parallel_evaluator.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

TEST(ParallelEvaluator, CallsEveryNumberOnce) {
  for (const int threads : {1, 2, 5}) {
    std::vector<int> calls(100);
    ParallelFor(100, threads, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
    EXPECT_EQ(calls, std::vector<int>(100, 1));
  }
}

// Fails below 0, is short below 1, is not a number below 2, and right from there.
FunctionManifold Faulty() {
  return FunctionManifold(testing::Over(VectorXd::Constant(1, -1), VectorXd::Constant(1, 3), 2,
                                        [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
                                          if (q[0] < 0)
                                            return absl::InternalError("a negative length");
                                          if (q[0] < 1) return VectorXd(VectorXd::Zero(1));
                                          if (q[0] < 2)
                                            return VectorXd(VectorXd::Constant(
                                                2, std::numeric_limits<double>::quiet_NaN()));
                                          return VectorXd(VectorXd::Constant(2, q[0]));
                                        }));
}

TEST(ParallelEvaluator, CountsFailuresAndKeepsOrder) {
  const FunctionManifold manifold = Faulty();
  ParallelEvaluator evaluator(manifold, 3);
  std::vector<VectorXd> points;
  for (const double q : {2.5, -0.5, 0.5, 1.5, 2.0, -0.25})
    points.push_back(VectorXd::Constant(1, q));
  const auto values = evaluator.Evaluate(points);
  ASSERT_EQ(values.size(), 6u);
  ASSERT_TRUE(values[0].ok() && values[4].ok());
  EXPECT_EQ((*values[0])[0], 2.5);
  EXPECT_EQ((*values[4])[0], 2.0);
  for (const std::size_t i : {1, 2, 3, 5}) EXPECT_FALSE(values[i].ok());
  EXPECT_EQ(evaluator.evaluations(), 6);
  EXPECT_EQ(evaluator.failures(), 4);
  ASSERT_EQ(evaluator.messages().size(), 3u);
  EXPECT_EQ(evaluator.messages()[0], "a negative length");
}

}  // namespace
}  // namespace mortise::retrieval
