// When rounds at the end of a budget begin, and what they ask for.
#include "services/pareto/sources/front_finishing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/sources/outlier_repair.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

// The front is u2 = 0.5; anything else is worse in both metrics.
VectorXd SmoothMetrics(const VectorXd& u) {
  const double off = std::pow(u[1] - 0.5, 2);
  return Eigen::Vector2d(u[0] + off, 1 - std::sqrt(u[0]) + off);
}

using MetricsOfDesign = std::function<VectorXd(const VectorXd&)>;

// Near the front, none quite on it.
Archive NearFront(int count, const MetricsOfDesign& metrics) {
  Random random(3);
  Archive archive;
  for (int i = 0; i < count; ++i) {
    const VectorXd u = Eigen::Vector2d((i + 0.5) / count, 0.5 + 0.04 * (random.Uniform() - 0.5));
    archive.Add({u, true, metrics(u), {}, {}});
  }
  return archive;
}

// Evaluates all that a round asks for; how many designs that was.
int EvaluateAll(PointSource& round, Archive& archive, const MetricsOfDesign& metrics) {
  int count = 0;
  while (const std::optional<VectorXd> u = round.Ask(archive)) {
    round.Tell(archive, archive.Add({*u, true, metrics(*u), {}, {}}));
    ++count;
  }
  EXPECT_TRUE(round.Finished());
  return count;
}

FrontFinishing::Options Budget(std::int64_t evaluations, bool is_ample) {
  return {.evaluations = evaluations,
          .is_ample = is_ample,
          .window = 8,
          .cells = {.cells_per_angle = 1000}};
}

TEST(FrontFinishing, BeginsTowardsTheEndOnly) {
  const Archive archive = NearFront(100, SmoothMetrics);
  FrontFinishing scarce(Budget(1000, false)), ample(Budget(1000, true));
  EXPECT_EQ(scarce.NextRound(archive, 51), nullptr);
  EXPECT_NE(scarce.NextRound(archive, 50), nullptr);
  EXPECT_EQ(ample.NextRound(archive, 451), nullptr);
  EXPECT_NE(ample.NextRound(archive, 450), nullptr);
}

TEST(FrontFinishing, WaitsForTheEndOfARound) {
  Archive archive = NearFront(100, SmoothMetrics);
  FrontFinishing finishing(Budget(1000, true));
  const std::unique_ptr<PointSource> round = finishing.NextRound(archive, 450);
  ASSERT_NE(round, nullptr);
  EXPECT_EQ(finishing.NextRound(archive, 400), nullptr);
  EvaluateAll(*round, archive, SmoothMetrics);
  EXPECT_NE(finishing.NextRound(archive, 400), nullptr);
}

TEST(FrontFinishing, PolishesEverythingOnceThatHasShownToPay) {
  Archive archive = NearFront(300, SmoothMetrics);
  const std::size_t outliers = RepairedOutliers(archive, archive.CurrentScaling(), 225).size();
  FrontFinishing finishing(Budget(1000, true));
  std::int64_t left = 450;
  const int trial = EvaluateAll(*finishing.NextRound(archive, left), archive, SmoothMetrics);
  EXPECT_LE(trial, 32 + static_cast<int>(outliers));
  left -= trial;
  const std::unique_ptr<PointSource> second = finishing.NextRound(archive, left);
  ASSERT_NE(second, nullptr) << "early, as polishing pays";
  const int polished = EvaluateAll(*second, archive, SmoothMetrics);
  EXPECT_GT(polished, 60);
  EXPECT_LE(polished, left);
  // What none dominates is on the front now, nearly all of it.
  int on_front = 0;
  for (const std::size_t entry : archive.non_dominated()) {
    on_front += std::abs(archive[entry].u[1] - 0.5) < 2e-3 ? 1 : 0;
  }
  EXPECT_GT(on_front, 0.8 * static_cast<double>(archive.non_dominated().size()));
}

TEST(FrontFinishing, StaysWithTrialsWhereModelsAreOfNoUse) {
  Random noise(11);
  const MetricsOfDesign rough = [&](const VectorXd& u) {
    return VectorXd(SmoothMetrics(u) + VectorXd::Constant(2, 0.3 * noise.Uniform()));
  };
  Archive archive = NearFront(300, rough);
  FrontFinishing finishing(Budget(2000, true));
  const auto round = [&](std::int64_t left) -> int {
    const auto outliers = RepairedOutliers(archive, archive.CurrentScaling(), left / 2);
    const std::unique_ptr<PointSource> next = finishing.NextRound(archive, left);
    if (next == nullptr) return -1;
    return EvaluateAll(*next, archive, rough) - static_cast<int>(outliers.size());
  };
  EXPECT_LE(round(900), 32);
  for (const std::int64_t left : {600, 400, 267, 178}) {
    EXPECT_EQ(round(left + 1), -1) << "only once a third of what was left is spent";
    const int polished = round(left);
    EXPECT_NE(polished, -1) << left;
    EXPECT_LE(polished, 32) << left;
  }
  EXPECT_FALSE(finishing.PolishesOnly(10));
}

// A design that was known is neither polished nor kept.
TEST(FrontFinishing, DoesNotPayWhereNothingNewComesOfIt) {
  Archive archive = NearFront(300, SmoothMetrics);
  FrontFinishing finishing(Budget(1000, true));
  for (const std::int64_t left : {450, 300, 200, 133}) {
    const std::unique_ptr<PointSource> round = finishing.NextRound(archive, left);
    ASSERT_NE(round, nullptr) << left;
    while (round->Ask(archive)) round->Tell(archive, 7);
    EXPECT_EQ(finishing.NextRound(archive, left - 1), nullptr) << left;
  }
  EXPECT_FALSE(finishing.PolishesOnly(10));
}

TEST(FrontFinishing, LeavesTheLastEvaluationsToPolishing) {
  Archive archive = NearFront(300, SmoothMetrics);
  FrontFinishing finishing(Budget(1000, true));
  EXPECT_FALSE(finishing.PolishesOnly(10)) << "nothing has shown that it pays";
  for (const std::int64_t left : {450, 400, 200, 100, 50}) {
    const std::unique_ptr<PointSource> round = finishing.NextRound(archive, left);
    if (round != nullptr) EvaluateAll(*round, archive, SmoothMetrics);
  }
  EXPECT_FALSE(finishing.PolishesOnly(20));
  EXPECT_TRUE(finishing.PolishesOnly(19));
}

}  // namespace
}  // namespace mortise::pareto
