// What becomes of a discovery where designs cannot be evaluated, or the evaluator fails.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, SaysWhyDesignsFailed) {
  evaluator_.FailFrom(0.6,
                      PreconditionFailed("RIGID_MOTION", "nothing holds the seat", "supports"));
  const v1::Operation operation = Wait(Discover(Request(60)).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_NE(operation.progress().message().find(" RIGID_MOTION"), std::string::npos)
      << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  std::int64_t count = 0;
  bool named = false;
  for (const v1::EvaluationFailure& failure : front.failures()) {
    count += failure.count();
    if (failure.reason() != "RIGID_MOTION") continue;
    named = true;
    EXPECT_NE(failure.message().find("nothing holds the seat"), std::string::npos);
    ASSERT_EQ(failure.parameters_size(), kDimensions);
    EXPECT_GE(failure.parameters(0), 0.6);
  }
  EXPECT_TRUE(named);
  EXPECT_EQ(count, front.failed_evaluations());
}

TEST_F(ParetoServiceTest, GoesOnWithoutDesignsThatTakeTooMuch) {
  evaluator_.FailFrom(0.6, TooLarge("the evaluation", "the memory at hand"));
  const v1::Front front = FrontOf(Wait(Discover(Request(60)).name()));
  EXPECT_GT(front.points_size(), 0);
  EXPECT_GT(front.failed_evaluations(), 0);
  EXPECT_EQ(front.evaluations(), 60);
  EXPECT_EQ(evaluator_.evaluations(), 60);  // none was asked again
}

TEST_F(ParetoServiceTest, EndsAtOnceWhereTheSubjectLacksSomething) {
  // Half of the designs do not get so far that this would be seen.
  evaluator_.FailFrom(0, PreconditionFailed("NO_SUPPORTS", "nothing holds it", "boundary"), 0.5);
  const v1::Operation operation = Wait(Discover(Request(5000)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(error.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(error).reason, "SUBJECT_UNUSABLE");
  EXPECT_EQ(DetailOf(error).field, "templates/zdt1");
  for (const char* part : {"templates/zdt1", "nothing holds it", "NO_SUPPORTS"}) {
    EXPECT_NE(error.message().find(part), std::string::npos) << error;
  }
  EXPECT_LT(evaluator_.evaluations(), 100);
}

TEST_F(ParetoServiceTest, SpendsItsBudgetWherePartsAreLoose) {
  // In the same words for each, and for the default design; others may hold all the same.
  evaluator_.FailFrom(0, PreconditionFailed("RIGID_MOTION", "the seat is free to move", "seat"));
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  EXPECT_EQ(DetailOf(rpc::FromProto(operation.error())).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_EQ(evaluator_.evaluations(), 40);
}

TEST_F(ParetoServiceTest, GoesOnWhereTheDefaultDesignWorks) {
  // Only the default design, with x0 = 0, works; all others lack something.
  evaluator_.FailFrom(1e-9, PreconditionFailed("NO_SUPPORTS", "nothing holds it", "boundary"));
  const v1::Operation operation = Wait(Discover(Request(30)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  EXPECT_EQ(DetailOf(rpc::FromProto(operation.error())).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_EQ(evaluator_.evaluations(), 31);
}

TEST_F(ParetoServiceTest, SpendsItsBudgetOnDesignsThatFailForThemselves) {
  evaluator_.FailFrom(0, InvalidField("points", "cannot be built"));
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(error.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find("40 FIELD_INVALID, such as"), std::string::npos) << error;
  EXPECT_EQ(evaluator_.evaluations(), 40);
}

TEST_F(ParetoServiceTest, KeepsWhatWasFoundWhenTheEvaluatorIsLost) {
  for (std::atomic<bool>* fault : {&evaluator_.lost_, &evaluator_.misnumbers_}) {
    evaluator_.HoldAfter(60);
    const v1::Operation started = Discover(Request(5000));
    evaluator_.WaitUntilHeld();
    *fault = true;
    evaluator_.Release();
    const v1::Operation operation = Wait(started.name());
    *fault = false;
    ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
    EXPECT_EQ(operation.error().code(), static_cast<int>(absl::StatusCode::kInternal));
    const std::string& message = operation.error().message();
    const char* const why = fault == &evaluator_.lost_ ? "licence" : "was not asked for";
    EXPECT_NE(message.find(why), std::string::npos) << message;
    const std::size_t at = message.find("fronts/");
    ASSERT_NE(at, std::string::npos) << message;
    v1::GetFrontRequest get;
    get.set_name(message.substr(at, message.find(' ', at) - at));
    grpc::ClientContext context;
    v1::Front front;
    ASSERT_TRUE(fronts_->GetFront(&context, get, &front).ok()) << get.name();
    EXPECT_EQ(front.stop_reason(), "EVALUATOR_LOST");
    EXPECT_GT(front.points_size(), 0);
    EXPECT_GE(front.evaluations(), 50);
  }
}

TEST_F(ParetoServiceTest, SaysThatAMetricIsMissing) {
  evaluator_.left_out_ = "gain";
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED);
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find(" NOT_FINITE, such as: the evaluator left out a metric"),
            std::string::npos)
      << error;
}

TEST_F(ParetoServiceTest, SaysWhichMetricIsNotFinite) {
  evaluator_.useless_ = "gain";
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED);
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find("NOT_FINITE, such as: the evaluator left out"), std::string::npos)
      << error;
  EXPECT_NE(error.message().find("not finite: gain"), std::string::npos) << error;
}

// As the simulator tells of designs for which a customer's evaluator reported NaN.
TEST_F(ParetoServiceTest, CountsDesignsThatWereNotFinite) {
  evaluator_.FailFrom(
      0.5, PreconditionFailed("NOT_FINITE", "not a finite number: gain", "result.metrics[1]"));
  const v1::Front front = FrontOf(Wait(Discover(Request(60)).name()));
  ASSERT_GT(front.failures_size(), 0);
  std::int64_t count = 0;
  for (const v1::EvaluationFailure& failure : front.failures()) {
    if (failure.reason() == "NOT_FINITE") {
      count += failure.count();
      EXPECT_EQ(failure.message(), "not a finite number: gain");
    }
  }
  EXPECT_GT(count, 0);
  evaluator_.FailFrom(
      0, PreconditionFailed("NOT_FINITE", "not a finite number: gain", "result.metrics[1]"));
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN") << error;
  EXPECT_NE(error.message().find("NOT_FINITE, such as: not a finite number: gain"),
            std::string::npos)
      << error;
}

}  // namespace
}  // namespace mortise::pareto
