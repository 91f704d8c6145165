// Maps where the disk has no room left.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "tests/integration/services/interpolator/shaped_maps_fixture.h"
#include "tests/support/private_postgresql.h"

namespace mortise::interpolator {
namespace {

// All files of maps, half-written ones included. Answers and records are in PostgreSQL, so that
// only these are limited.
class FullDiskTest : public ShapedMapsTest {
 protected:
  void SetUp() override {
    ShapedMapsTest::SetUp();
    auto started = mortise::testing::PrivatePostgresql::Start();
    ASSERT_TRUE(started.ok()) << started.status();
    postgresql_ = *std::move(started);
    StartInterpolator({}, postgresql_->url());
  }

  // Stands in for a full disk: files of the service cannot grow beyond so many bytes.
  void LimitFiles(rlim_t bytes) {
    const rlimit limit{.rlim_cur = bytes, .rlim_max = RLIM_INFINITY};
    ASSERT_EQ(::prlimit(interpolator_->pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  }

  std::set<std::filesystem::path> Files() {
    std::set<std::filesystem::path> files;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(interpolator_->folder() / "blobs")) {
      if (entry.is_regular_file()) files.insert(entry.path());
    }
    return files;
  }

  int CountMaps() {
    v1::ListMapsResponse listed;
    grpc::ClientContext context;
    EXPECT_TRUE(maps_->ListMaps(&context, {}, &listed).ok());
    return listed.maps_size();
  }

  std::unique_ptr<mortise::testing::PrivatePostgresql> postgresql_;
};

TEST_F(FullDiskTest, EndsBuildsKeepsNothingOfThemAndServesWhatWasThere) {
  const v1::DesignMap map = Built(ShapeRequest(30));
  const std::string before = Shape(At(map.name(), 0.37, 11)).SerializeAsString();
  const std::set<std::filesystem::path> files = Files();
  v1::BuildMapRequest other = ShapeRequest(30);
  other.mutable_specification()->set_seed(12);
  other.mutable_specification()->clear_metrics();
  other.mutable_specification()->mutable_shape()->mutable_fields()->RemoveLast();
  LimitFiles(100);
  for (const v1::BuildMapRequest& request : {other, Request(40)}) {
    const v1::Operation operation = Wait(Build(request).name());
    EXPECT_EQ(operation.state(), v1::Operation::FAILED);
    EXPECT_EQ(operation.error().code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(DetailOf(rpc::FromProto(operation.error())).reason, "DISK_FULL")
        << operation.error().message();
    EXPECT_NE(operation.error().message().find("cannot be stored"), std::string::npos)
        << operation.error().message();
  }
  EXPECT_EQ(CountMaps(), 1);
  EXPECT_EQ(Files(), files);
  EXPECT_EQ(Shape(At(map.name(), 0.37, 11)).SerializeAsString(), before);
  EXPECT_EQ(Evaluate(map.name(), {0.37, 11}).values_size(), 1);
  // With room again both are built.
  LimitFiles(RLIM_INFINITY);
  v1::BuildMapRequest metrics = Request(40);
  other.set_request_id(NewIdentifier());
  EXPECT_EQ(Wait(Build(other).name()).state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(Wait(Build(metrics).name()).state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(CountMaps(), 3);
}

}  // namespace
}  // namespace mortise::interpolator
