// Discovery where there is nothing to trade, or answers are useless: it ends, says so, and keeps
// what was found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <set>
#include <vector>

#include "services/pareto/discovery/discovery_run.h"
#include "services/pareto/front/front_remarks.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

std::unique_ptr<Discovery> Complete(const std::function<VectorXd(const VectorXd&)>& metrics,
                                    std::int64_t evaluations, Eigen::Index parameters = 3) {
  const DesignSpace space{VectorXd::Zero(parameters), VectorXd::Ones(parameters)};
  Discovery::Options options;
  options.evaluations = evaluations;
  options.surrogate = Discovery::Surrogate::kNever;
  const Eigen::Index d = metrics(space.lower).size();
  auto discovery = *Discovery::Create(space, d, options);
  while (!discovery->Finished()) {
    const auto proposal = discovery->Ask();
    if (!proposal) continue;
    Evaluation evaluation;
    evaluation.x = proposal->x;
    evaluation.status = EvaluationStatus::kEvaluated;
    evaluation.metrics = metrics(proposal->x);
    EXPECT_TRUE(discovery->Tell(proposal->number, std::move(evaluation)).ok());
  }
  return discovery;
}

std::vector<std::string> Remarks(const Discovery& discovery,
                                 const std::vector<std::string>& names = {"mass", "cost"}) {
  return FrontRemarks(discovery.archive(), discovery.front(), names);
}

double Bowl(const VectorXd& x) { return (x.array() - 0.3).square().sum(); }

TEST(DegenerateDiscoveryTest, SaysThatAMetricIsConstant) {
  for (const std::int64_t evaluations : {30, 200}) {
    const auto discovery = Complete(
        [](const VectorXd& x) -> VectorXd { return Eigen::Vector2d(7, Bowl(x)); }, evaluations);
    const Front front = discovery->front();
    ASSERT_EQ(front.points.size(), 1u);
    EXPECT_LT(front.points[0].metrics[1], evaluations == 30 ? 0.05 : 1e-3);
    EXPECT_THAT(Remarks(*discovery),
                Contains(AllOf(HasSubstr("'mass' is the same for all"), HasSubstr("designs"))));
  }
}

TEST(DegenerateDiscoveryTest, SaysThatAllMetricsAreConstant) {
  for (const Eigen::Index d : {2, 3}) {
    const auto discovery =
        Complete([d](const VectorXd&) -> VectorXd { return VectorXd::Constant(d, 4); }, 200);
    EXPECT_EQ(discovery->front().points.size(), 1u);
    EXPECT_NE(discovery->summary().stop_reason, Discovery::StopReason::kRunning);
    EXPECT_EQ(Remarks(*discovery, {"mass", "cost", "time"}).size(), static_cast<std::size_t>(d) + 1)
        << "each, and that it is a single point";
  }
}

TEST(DegenerateDiscoveryTest, SaysThatEqualMetricsDoNotConflict) {
  for (const auto& other : std::vector<std::function<double(double)>>{
           [](double f) { return f; }, [](double f) { return 5 + 1e6 * f; },
           [](double f) { return std::exp(f); }}) {
    const auto discovery = Complete(
        [&](const VectorXd& x) -> VectorXd { return Eigen::Vector2d(Bowl(x), other(Bowl(x))); },
        150);
    const Front front = discovery->front();
    ASSERT_EQ(front.points.size(), 1u);
    EXPECT_LT(front.points[0].metrics[0], 1e-3);
    EXPECT_THAT(Remarks(*discovery), Contains(AllOf(HasSubstr("the best in 'mass' and 'cost'"),
                                                    HasSubstr("a single point"))));
  }
}

TEST(DegenerateDiscoveryTest, SaysNothingOfAFrontWithTradeOffs) {
  const auto discovery = Complete(
      [](const VectorXd& x) -> VectorXd { return Eigen::Vector2d(Bowl(x), x.squaredNorm()); }, 100);
  EXPECT_GT(discovery->front().points.size(), 5u);
  EXPECT_TRUE(Remarks(*discovery).empty());
}

TEST(DegenerateDiscoveryTest, KeepsWhatHasNumbersAmongWhatHasNot) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto discovery = Complete(
        [&](const VectorXd& x) -> VectorXd {
          return Eigen::Vector2d(x[0], x[1] > 0.5 ? bad : 1 - x[0] + x[2]);
        },
        120);
    const Discovery::Summary summary = discovery->summary();
    EXPECT_GT(summary.failed, 0);
    ASSERT_EQ(summary.failures.size(), 1u);
    EXPECT_EQ(summary.failures[0].reason, "NOT_FINITE");
    EXPECT_GT(discovery->front().points.size(), 5u);
    for (const FrontPoint& point : discovery->front().points) EXPECT_LE(point.x[1], 0.5);
  }
}

TEST(DegenerateDiscoveryTest, SpendsItsBudgetWhereNothingHasNumbers) {
  const auto discovery = Complete(
      [](const VectorXd&) -> VectorXd {
        return VectorXd::Constant(2, std::numeric_limits<double>::quiet_NaN());
      },
      60);
  EXPECT_EQ(discovery->summary().failed, 60);
  EXPECT_TRUE(discovery->front().points.empty());
  EXPECT_TRUE(Remarks(*discovery).empty());
}

TEST(DegenerateDiscoveryTest, EndsWhereEveryParameterIsFixed) {
  const DesignSpace space{VectorXd::Ones(2), VectorXd::Ones(2)};
  Discovery::Options options;
  options.evaluations = 50;
  const auto discovery = *Discovery::Create(space, 2, options);
  int asked = 0;
  while (!discovery->Finished()) {
    const auto proposal = discovery->Ask();
    if (!proposal) continue;
    ++asked;
    Evaluation evaluation;
    evaluation.x = proposal->x;
    evaluation.status = EvaluationStatus::kEvaluated;
    evaluation.metrics = Eigen::Vector2d(1, 2);
    ASSERT_TRUE(discovery->Tell(proposal->number, evaluation).ok());
  }
  EXPECT_LE(asked, 50);
  EXPECT_EQ(discovery->front().points.size(), 1u);
}

// Values that can only be set in coarse steps, and far more evaluations than the front needs. The
// bounds are such that unit coordinates do not give designs back to the last bit.
TEST(DegenerateDiscoveryTest, EvaluatesNoDesignTwiceWhereValuesHaveSteps) {
  DesignSpace space{VectorXd::Constant(2, 0.3), VectorXd::Constant(2, 1.7)};
  space.step = VectorXd::Constant(2, 0.0175);
  for (const std::uint64_t seed : {1, 2}) {
    Discovery::Options options;
    options.evaluations = 1000;
    options.surrogate = Discovery::Surrogate::kNever;
    options.seed = seed;
    options.stall_tracks = 0;
    auto discovery = *Discovery::Create(space, 2, options);
    std::set<std::vector<double>> known;
    std::deque<Discovery::Proposal> under_way;
    while (!discovery->Finished()) {
      while (auto proposal = discovery->Ask()) under_way.push_back(*std::move(proposal));
      if (under_way.empty()) break;
      const Discovery::Proposal proposal = under_way.front();
      under_way.pop_front();
      EXPECT_TRUE(known.insert({proposal.x.begin(), proposal.x.end()}).second);
      Evaluation evaluation;
      evaluation.x = proposal.x;
      evaluation.status = EvaluationStatus::kEvaluated;
      const VectorXd& x = proposal.x;
      evaluation.metrics = Eigen::Vector2d(std::pow(x[0] - 0.6, 2) + std::pow(x[1] - 1, 2),
                                           std::pow(x[0] - 1.4, 2) + std::pow(x[1] - 1.2, 2));
      ASSERT_TRUE(discovery->Tell(proposal.number, std::move(evaluation)).ok());
    }
    EXPECT_TRUE(discovery->Finished());
    EXPECT_GT(known.size(), 800u);
  }
}

}  // namespace
}  // namespace mortise::pareto
