// Fronts that are explored: points picked, walked along, and limits.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/bench/pareto/benchmark_problems.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, ExploresAFront) {
  const v1::Front front = FrontOf(Wait(Discover(Request(200)).name()));
  const int middle = front.points_size() / 2;
  v1::PickPointRequest pick;
  pick.set_name(front.name());
  pick.set_index(middle);
  v1::PickPointResponse here;
  ASSERT_TRUE(Asked(pick, here).ok());
  EXPECT_EQ(here.index(), middle);
  EXPECT_EQ(here.neighbours_size(), 2);
  EXPECT_EQ(here.path_size(), 0);
  ASSERT_EQ(here.improvements_size(), 2);
  // ZDT1's front is traded by its first parameter alone: gain = sqrt(mass) - 1 there.
  const v1::FrontImprovement& lighter = here.improvements(0);
  EXPECT_EQ(lighter.metric(), "mass");
  EXPECT_EQ(lighter.metrics(0).value(), -1);
  EXPECT_EQ(lighter.parameters(0).name(), "x0");
  EXPECT_GT(lighter.parameters(0).share(), 0.9);
  EXPECT_NEAR(lighter.parameters(0).value(), -1, 0.1);
  const double slope = 0.5 / std::sqrt(here.metrics(0).value());
  EXPECT_NEAR(lighter.metrics(1).value(), -slope, 0.2 * slope);

  pick.set_improve("gain");
  pick.set_steps(3);
  v1::PickPointResponse walked;
  ASSERT_TRUE(Asked(pick, walked).ok());
  EXPECT_EQ(walked.path_size(), 3);
  EXPECT_EQ(walked.path(2), walked.index());
  EXPECT_GT(walked.metrics(1).value(), here.metrics(1).value()) << "gain is maximised";

  v1::RestrictFrontRequest light_ones;
  light_ones.set_name(front.name());
  v1::FrontLimit& limit = *light_ones.add_limits();
  limit.set_name("mass");
  limit.set_maximum(0.5);
  v1::RestrictFrontResponse rest;
  grpc::ClientContext context;
  ASSERT_TRUE(fronts_->RestrictFront(&context, light_ones, &rest).ok());
  int light = 0;
  for (const v1::FrontPoint& point : front.points()) light += point.metrics(0) <= 0.5;
  EXPECT_EQ(rest.points_size(), light);
  EXPECT_LE(rest.metrics(0).maximum(), 0.5);
  EXPECT_EQ(rest.metrics(0).unit(), "kg");
  EXPECT_EQ(rest.parameters_size(), kDimensions);
  ASSERT_EQ(rest.conflicts_size(), 1);
  EXPECT_LT(rest.conflicts(0).correlation(), -0.8);
}

TEST_F(ParetoServiceTest, RefusesBadQuestionsAboutAFront) {
  const v1::Front front = FrontOf(Wait(Discover(Request(60)).name()));
  const auto refused = [&](auto change) {
    v1::PickPointRequest pick;
    pick.set_name(front.name());
    pick.set_index(0);
    change(pick);
    v1::PickPointResponse response;
    return Asked(pick, response).error_code();
  };
  using Pick = v1::PickPointRequest;
  EXPECT_EQ(refused([](Pick&) {}), grpc::StatusCode::OK);
  const auto invalid = grpc::StatusCode::INVALID_ARGUMENT;
  EXPECT_EQ(refused([](Pick& p) { p.clear_index(); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_index(100'000); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.add_embedding(0.5); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_steps(2); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_improve("beauty"); }), invalid);
  EXPECT_EQ(refused([](Pick& p) {
              p.set_improve("mass");
              p.set_steps(-1);
            }),
            invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_name("fronts/absent"); }), grpc::StatusCode::NOT_FOUND);

  const auto restricted = [&](const std::string& name, double minimum, double maximum) {
    v1::RestrictFrontRequest request;
    request.set_name(front.name());
    v1::FrontLimit& limit = *request.add_limits();
    limit.set_name(name);
    limit.set_minimum(minimum);
    limit.set_maximum(maximum);
    v1::RestrictFrontResponse response;
    grpc::ClientContext context;
    return fronts_->RestrictFront(&context, request, &response).error_code();
  };
  EXPECT_EQ(restricted("mass", 5, 6), grpc::StatusCode::OK) << "nothing may remain";
  EXPECT_EQ(restricted("beauty", 0, 1), invalid);
  EXPECT_EQ(restricted("mass", 1, 0), invalid);
  EXPECT_EQ(restricted("x0", 0, std::numeric_limits<double>::quiet_NaN()), invalid);
}

// The designs at the ends, as they were evaluated, can be picked, and limits reach up to them.
TEST_F(ParetoServiceTest, FrontsReachTheBestThatWasEvaluated) {
  const v1::Front front = FrontOf(Wait(Discover(Request(200)).name()));
  double best_mass = 1e9, best_gain = -1e9;
  for (const Eigen::VectorXd& x : evaluator_.TakeEvaluated()) {
    const Evaluation evaluation = MakeBenchmarkProblem("ZDT1", kDimensions)->evaluate(x, false);
    best_mass = std::min(best_mass, evaluation.metrics[0]);
    best_gain = std::max(best_gain, -evaluation.metrics[1]);
  }
  for (const auto& [place, metric, best] :
       std::vector<std::tuple<double, int, double>>{{1, 0, best_mass}, {0, 1, best_gain}}) {
    v1::PickPointRequest pick;
    pick.set_name(front.name());
    pick.add_embedding(place);
    v1::PickPointResponse picked;
    ASSERT_TRUE(Asked(pick, picked).ok());
    EXPECT_EQ(picked.metrics(metric).value(), best);
    for (const v1::FrontImprovement& improvement : picked.improvements()) {
      EXPECT_NE(improvement.metric(), front.metric_names(metric)) << "nothing is better";
    }
    v1::RestrictFrontRequest request;
    request.set_name(front.name());
    v1::FrontLimit& limit = *request.add_limits();
    limit.set_name(front.metric_names(metric));
    if (metric == 0) limit.set_maximum(best);
    if (metric == 1) limit.set_minimum(best);
    grpc::ClientContext context;
    v1::RestrictFrontResponse rest;
    ASSERT_TRUE(fronts_->RestrictFront(&context, request, &rest).ok());
    ASSERT_EQ(rest.points_size(), 1);
    EXPECT_EQ(rest.points(0), picked.index());
  }
}

}  // namespace
}  // namespace mortise::pareto
