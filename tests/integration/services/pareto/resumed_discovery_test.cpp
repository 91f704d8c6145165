// Discoveries that go on: after kill -9, from earlier fronts, and to an early end.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/base/identifiers.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, SurvivesKillNineWithTheSameFront) {
  const v1::Front reference = FrontOf(Wait(Discover(Request(120)).name()));
  const int before = evaluator_.evaluations();
  evaluator_.HoldAfter(60);
  const v1::Operation started = Discover(Request(120));
  evaluator_.WaitUntilHeld();
  pareto_->Kill();
  evaluator_.Release();
  pareto_->Start();
  Connect();
  const v1::Operation operation = Wait(started.name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  const v1::Front front = FrontOf(operation);
  ASSERT_EQ(front.points_size(), reference.points_size());
  for (int i = 0; i < front.points_size(); ++i) {
    EXPECT_EQ(front.points(i).SerializeAsString(), reference.points(i).SerializeAsString());
  }
  // What had been answered was not asked again, but for what was under way.
  EXPECT_LE(evaluator_.evaluations() - before, 120 + 16);
}

TEST_F(ParetoServiceTest, CancelKeepsTheBestSoFar) {
  evaluator_.HoldAfter(60);
  const v1::Operation started = Discover(Request(5000));
  evaluator_.WaitUntilHeld();
  grpc::ClientContext context;
  v1::CancelOperationRequest cancel;
  cancel.set_request_id(NewIdentifier());
  cancel.set_name(started.name());
  v1::Operation operation;
  ASSERT_TRUE(operations_->CancelOperation(&context, cancel, &operation).ok());
  operation = Wait(started.name());
  EXPECT_EQ(operation.state(), v1::Operation::CANCELLED);
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.stop_reason(), "CANCELLED");
  EXPECT_GT(front.points_size(), 0);
  EXPECT_LT(front.evaluations(), 100);
}

TEST_F(ParetoServiceTest, StartsFromAnEarlierFront) {
  const v1::Front before = FrontOf(Wait(Discover(Request(200)).name()));
  evaluator_.TakeEvaluated();
  v1::DiscoverFrontRequest request = Request(80);
  request.mutable_specification()->add_start_from(before.name());
  auto& bound = *request.mutable_specification()->add_bounds();
  bound.set_parameter("x0");
  bound.set_maximum(0.6);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(front.specification().start_from(0), before.name());
  EXPECT_EQ(front.remarks_size(), 0) << front.remarks(0);
  EXPECT_GT(front.hypervolume(), 0.6);
  // The first ten are of that front, within the new bound; the other way round within the window.
  std::set<std::vector<double>> known;
  for (const v1::FrontPoint& point : before.points()) {
    std::vector<double> x(point.parameters().begin(), point.parameters().end());
    x[0] = std::min(x[0], 0.6);
    known.insert(x);
  }
  const std::vector<Eigen::VectorXd> evaluated = evaluator_.TakeEvaluated();
  int repeated = 0;
  for (std::size_t i = 0; i < 18; ++i) {
    repeated += known.contains({evaluated[i].begin(), evaluated[i].end()}) ? 1 : 0;
  }
  EXPECT_EQ(repeated, 10);

  // Killed in the middle it goes on to the same front.
  evaluator_.HoldAfter(40);
  request.set_request_id(NewIdentifier());
  const v1::Operation started = Discover(request);
  evaluator_.WaitUntilHeld();
  pareto_->Kill();
  evaluator_.Release();
  pareto_->Start();
  Connect();
  const v1::Front resumed = FrontOf(Wait(started.name()));
  ASSERT_EQ(resumed.points_size(), front.points_size());
  for (int i = 0; i < front.points_size(); ++i) {
    EXPECT_EQ(resumed.points(i).SerializeAsString(), front.points(i).SerializeAsString());
  }

  request.mutable_specification()->set_start_from(0, "fronts/absent");
  v1::Operation operation;
  grpc::ClientContext absent;
  request.set_request_id(NewIdentifier());
  const grpc::Status missing = fronts_->DiscoverFront(&absent, request, &operation);
  EXPECT_EQ(missing.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_NE(missing.error_message().find("fronts/absent"), std::string::npos);
  for (const std::vector<std::string>& names :
       std::vector<std::vector<std::string>>{{"absent"}, {before.name(), before.name()}}) {
    grpc::ClientContext context;
    request.mutable_specification()->mutable_start_from()->Assign(names.begin(), names.end());
    request.set_request_id(NewIdentifier());
    EXPECT_EQ(fronts_->DiscoverFront(&context, request, &operation).error_code(),
              grpc::StatusCode::INVALID_ARGUMENT);
  }
}

TEST_F(ParetoServiceTest, SaysThatAnEvaluatorChangedItsAnswers) {
  const v1::Front before = FrontOf(Wait(Discover(Request(60)).name()));
  evaluator_.drift_ = 0.01;
  v1::DiscoverFrontRequest request = Request(60);
  request.mutable_specification()->add_start_from(before.name());
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  ASSERT_EQ(front.remarks_size(), 1);
  EXPECT_NE(front.remarks(0).find("changed its answers: 'mass'"), std::string::npos)
      << front.remarks(0);
}

}  // namespace
}  // namespace mortise::pareto
