// Maps whose building is interrupted, and files of maps that are damaged.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {
namespace {

TEST_F(InterpolatorServiceTest, SurvivesKillNineWithTheSameMap) {
  const v1::DesignMap reference = Built(Request(120));
  evaluator_.Forget();
  evaluator_.HoldAfter(50);
  const v1::Operation started = Build(Request(120));
  evaluator_.WaitUntilHeld();
  interpolator_->Kill();
  evaluator_.Release();
  interpolator_->Start();
  Connect();
  const v1::Operation operation = Wait(started.name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_EQ(MapOf(operation).sha256(), reference.sha256());
  EXPECT_EQ(evaluator_.designs(), reference.samples() + reference.probes());
  // What was under way when it was killed, a round at most, is all that was asked again.
  EXPECT_LE(evaluator_.most_of_one(), 2);
  EXPECT_LE(evaluator_.asked_again(), 16);
}

TEST_F(InterpolatorServiceTest, HasItsMapsAfterARestart) {
  const v1::DesignMap map = Built(Request(40));
  const double value = Evaluate(map.name(), {0.37, 11}).values(0);
  evaluator_.Forget();
  interpolator_->Kill();
  interpolator_->Start();
  Connect();
  EXPECT_EQ(Get(map.name()).sha256(), map.sha256());
  EXPECT_EQ(Evaluate(map.name(), {0.37, 11}).values(0), value);
  EXPECT_EQ(evaluator_.designs(), 0);
}

TEST_F(InterpolatorServiceTest, WaitsForAnEvaluatorThatIsAway) {
  evaluator_.HoldAfter(30);
  const v1::Operation started = Build(Request(100));
  evaluator_.WaitUntilHeld();
  EndEvaluator();
  evaluator_.Release();
  StartEvaluator();
  const v1::Operation operation = Wait(started.name());
  EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
}

TEST_F(InterpolatorServiceTest, CancelKeepsTheMapOfWhatWasSampled) {
  evaluator_.HoldAfter(100);
  const v1::Operation started = Build(Request(5000));
  evaluator_.WaitUntilHeld();
  grpc::ClientContext context;
  v1::CancelOperationRequest cancel;
  cancel.set_request_id(NewIdentifier());
  cancel.set_name(started.name());
  v1::Operation operation;
  ASSERT_TRUE(operations_->CancelOperation(&context, cancel, &operation).ok());
  operation = Wait(started.name());
  EXPECT_EQ(operation.state(), v1::Operation::CANCELLED);
  const v1::DesignMap map = MapOf(operation);
  EXPECT_EQ(map.stop_reason(), "CANCELLED");
  EXPECT_LE(map.samples() + map.probes(), 101);
  EXPECT_NEAR(Evaluate(map.name(), {0.5, 11}).values(0), MassOf(0.5, 11), 0.1);
}

TEST_F(InterpolatorServiceTest, CancelBeforeThereIsAMapKeepsNone) {
  evaluator_.HoldAfter(1);
  const v1::Operation started = Build(Request(5000));
  evaluator_.WaitUntilHeld();
  grpc::ClientContext context;
  v1::CancelOperationRequest cancel;
  cancel.set_request_id(NewIdentifier());
  cancel.set_name(started.name());
  v1::Operation operation;
  ASSERT_TRUE(operations_->CancelOperation(&context, cancel, &operation).ok());
  operation = Wait(started.name());
  EXPECT_EQ(operation.state(), v1::Operation::CANCELLED);
  EXPECT_FALSE(operation.has_result());
  v1::ListMapsResponse listed;
  grpc::ClientContext listing;
  ASSERT_TRUE(maps_->ListMaps(&listing, {}, &listed).ok());
  EXPECT_EQ(listed.maps_size(), 0);
}

// The one file of a folder of blobs.
std::filesystem::path OnlyFile(const std::filesystem::path& folder) {
  std::filesystem::path found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) found = entry.path();
  }
  return found;
}

TEST_F(InterpolatorServiceTest, NeverAnswersFromADamagedFile) {
  const v1::DesignMap map = Built(Request(40));
  const std::filesystem::path file = OnlyFile(interpolator_->folder() / "blobs");
  ASSERT_FALSE(file.empty());
  std::filesystem::permissions(file, std::filesystem::perms::owner_write,
                               std::filesystem::perm_options::add);
  {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(100);
    stream.put('\x7f');
  }
  v1::EvaluateMapRequest request;
  request.set_name(map.name());
  request.add_points(0.5);
  request.add_points(11);
  v1::EvaluateMapResponse response;
  const grpc::Status damaged = Asked(request, response);
  EXPECT_EQ(damaged.error_code(), grpc::StatusCode::DATA_LOSS) << damaged.error_message();
  EXPECT_NE(damaged.error_message().find(map.name()), std::string::npos);
  std::filesystem::remove(file);
  EXPECT_EQ(Asked(request, response).error_code(), grpc::StatusCode::DATA_LOSS);
}

}  // namespace
}  // namespace mortise::interpolator
