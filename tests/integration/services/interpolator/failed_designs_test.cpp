// Evaluators that fail: here and there, everywhere, or altogether.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/base/errors.h"
#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {
namespace {

TEST_F(InterpolatorServiceTest, CutsOffWhatCannotBeEvaluated) {
  evaluator_.Fail([](double x, double) { return x > 0.8; },
                  PreconditionFailed("RIGID_MOTION", "it can turn"));
  const v1::DesignMap map = Built(Request(200));
  EXPECT_GT(map.failed_evaluations(), 0);
  EXPECT_GT(map.cut_off_elements(), 0);
  EXPECT_LT(map.cut_off_elements(), map.elements());
  ASSERT_EQ(map.failures_size(), 1);
  EXPECT_EQ(map.failures(0).reason(), "RIGID_MOTION");
  EXPECT_EQ(map.failures(0).count(), map.failed_evaluations());
  ASSERT_EQ(map.failures(0).parameters_size(), 2);
  EXPECT_GT(map.failures(0).parameters(0), 0.8);
  const v1::EvaluateMapResponse response =
      Evaluate(map.name(), {0.2, 11, 0.99, 11, 0.5, 10.5}, true);
  ASSERT_EQ(response.uncovered_size(), 1);
  EXPECT_EQ(response.uncovered(0), 1);
  EXPECT_TRUE(std::isnan(response.values(2)));
  EXPECT_NEAR(response.values(0), MassOf(0.2, 11), 0.05);
  EXPECT_NEAR(response.values(5), StressOf(0.5, 10.5), 1);

  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(map.name());
  for (const double number : {0.2, 11.0, 0.99, 11.0}) request.add_points(number);
  const v1::MapVerification found = MapOf(Wait(Verify(request).name())).verification();
  EXPECT_EQ(found.points(), 2);
  EXPECT_EQ(found.failed(), 1);
}

TEST_F(InterpolatorServiceTest, EndsSoonWhereTheSubjectItselfIsAtFault) {
  evaluator_.Fail([](double, double) { return true; },
                  PreconditionFailed("NO_SUPPORT", "nothing holds it"));
  const v1::Operation operation = Wait(Build(Request(1000)).name());
  EXPECT_EQ(operation.state(), v1::Operation::FAILED);
  EXPECT_EQ(operation.error().code(), static_cast<int>(grpc::StatusCode::FAILED_PRECONDITION));
  EXPECT_NE(operation.error().message().find("nothing holds it"), std::string::npos)
      << operation.error().message();
  EXPECT_LT(evaluator_.evaluations(), 100);
}

TEST_F(InterpolatorServiceTest, SaysThatNoDesignCouldBeEvaluated) {
  evaluator_.not_finite_ = true;
  const v1::Operation operation = Wait(Build(Request(60)).name());
  EXPECT_EQ(operation.state(), v1::Operation::FAILED);
  EXPECT_EQ(operation.error().code(), static_cast<int>(grpc::StatusCode::FAILED_PRECONDITION));
  EXPECT_NE(operation.error().message().find("NOT_FINITE"), std::string::npos)
      << operation.error().message();
  v1::ListMapsResponse listed;
  grpc::ClientContext listing;
  ASSERT_TRUE(maps_->ListMaps(&listing, {}, &listed).ok());
  EXPECT_EQ(listed.maps_size(), 0);
}

TEST_F(InterpolatorServiceTest, FailsWithWhatTheEvaluatorFailsWith) {
  evaluator_.lost_ = true;
  const v1::Operation operation = Wait(Build(Request(60)).name());
  EXPECT_EQ(operation.state(), v1::Operation::FAILED);
  EXPECT_NE(operation.error().message().find("licence has run out"), std::string::npos)
      << operation.error().message();
}

}  // namespace
}  // namespace mortise::interpolator
