// Shapes of maps on disk: after interruptions and restarts, damaged, beyond the quota, deleted.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/integration/services/interpolator/shaped_maps_fixture.h"

namespace mortise::interpolator {
namespace {

std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  return files;
}

void Damage(const std::filesystem::path& file) {
  std::filesystem::permissions(file, std::filesystem::perms::owner_write,
                               std::filesystem::perm_options::add);
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(70);
  const auto byte = static_cast<char>(stream.get() ^ 0x55);
  stream.seekp(70);
  stream.put(byte);
}

std::string Gigabytes(double bytes) {
  std::ostringstream text;
  text << bytes / 1e9;
  return text.str();
}

TEST_F(ShapedMapsTest, SurvivesKillNineWithTheSameShapes) {
  const v1::DesignMap reference = Built(ShapeRequest(60));
  evaluator_.Forget();
  evaluator_.HoldAfter(30);
  const v1::Operation started = Build(ShapeRequest(60));
  evaluator_.WaitUntilHeld();
  interpolator_->Kill();
  evaluator_.Release();
  interpolator_->Start();
  Connect();
  const v1::Operation operation = Wait(started.name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_EQ(MapOf(operation).sha256(), reference.sha256());
  EXPECT_LE(evaluator_.most_of_one(), 2);
}

TEST_F(ShapedMapsTest, HasItsShapesAfterARestart) {
  const v1::DesignMap map = Built(ShapeRequest(40));
  const v1::MapShape before = Shape(At(map.name(), 0.37, 11));
  interpolator_->Kill();
  evaluator_.files().Lose();
  interpolator_->Start();
  Connect();
  EXPECT_EQ(Shape(At(map.name(), 0.37, 11)).SerializeAsString(), before.SerializeAsString());
}

TEST_F(ShapedMapsTest, NeverAnswersFromDamagedShapes) {
  const v1::DesignMap map = Built(ShapeRequest(30));
  for (const auto& file : FilesIn(interpolator_->folder() / "blobs")) {
    if (file.filename() != map.sha256()) Damage(file);
  }
  v1::MapShape shape;
  const grpc::Status damaged = AskShape(At(map.name(), 0.37, 11), shape);
  EXPECT_EQ(damaged.error_code(), grpc::StatusCode::DATA_LOSS) << damaged.error_message();
  // Metrics are not in those files; and building it again mends it.
  EXPECT_EQ(Evaluate(map.name(), {0.37, 11}).values_size(), 1);
  const v1::DesignMap again = Built(ShapeRequest(30));
  EXPECT_EQ(again.sha256(), map.sha256());
  EXPECT_TRUE(AskShape(At(map.name(), 0.37, 11), shape).ok());
}

TEST_F(ShapedMapsTest, EndsBuildsThatWouldTakeMoreDiskThanTheQuota) {
  const std::int64_t bytes = Built(ShapeRequest(30)).bytes();
  // Room for one such map, with the shapes of its probes while it is built, and none for two.
  StartInterpolator({"--map-disk-quota=" + Gigabytes(2.0 * static_cast<double>(bytes))});
  const v1::DesignMap map = Built(ShapeRequest(30));
  const v1::Operation refused = Wait(Build(ShapeRequest(30)).name());
  EXPECT_EQ(refused.state(), v1::Operation::FAILED);
  EXPECT_EQ(refused.error().code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_NE(refused.error().message().find("map-disk-quota"), std::string::npos)
      << refused.error().message();
  // A map that is deleted makes room.
  v1::DeleteMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(map.name());
  grpc::ClientContext context;
  v1::DeleteMapResponse response;
  ASSERT_TRUE(maps_->DeleteMap(&context, request, &response).ok());
  v1::MapShape shape;
  EXPECT_EQ(AskShape(At(map.name(), 0.5, 11), shape).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Wait(Build(ShapeRequest(30)).name()).state(), v1::Operation::SUCCEEDED);
}

}  // namespace
}  // namespace mortise::interpolator
