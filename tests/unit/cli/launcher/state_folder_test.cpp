#include "cli/launcher/state_folder.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"

namespace mortise::cli {
namespace {

class StateFolderTest : public testing::Test {
 protected:
  StateFolderTest() : folder_(std::filesystem::path(testing::TempDir()) / NewIdentifier()) {}
  ~StateFolderTest() override { std::filesystem::remove_all(folder_); }
  const std::filesystem::path folder_;
};

TEST_F(StateFolderTest, SecondLauncherIsRefusedAndToldWhy) {
  const auto first = StateFolderLock::Take(folder_);
  ASSERT_TRUE(first.ok()) << first.status();
  const absl::Status second = StateFolderLock::Take(folder_).status();
  EXPECT_EQ(second.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(second).reason, "STATE_FOLDER_IN_USE");
  EXPECT_NE(second.message().find(folder_.string()), absl::string_view::npos);
}

TEST_F(StateFolderTest, LockEndsWithItsHolder) {
  { ASSERT_TRUE(StateFolderLock::Take(folder_).ok()); }
  EXPECT_TRUE(StateFolderLock::Take(folder_).ok());
}

TEST_F(StateFolderTest, UnusableFolderIsNamed) {
  ASSERT_TRUE(WriteFile(folder_ / "file", "x").ok());
  const absl::Status status = StateFolderLock::Take(folder_ / "file" / "state").status();
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message().find("file"), absl::string_view::npos);
}

TEST_F(StateFolderTest, HouseIsReadBackAsWritten) {
  const RunningHouse house{.launcher = 42,
                           .gateway_grpc = "127.0.0.1:7700",
                           .gateway_http = "127.0.0.1:7780",
                           .plain_text = true,
                           .authority = "/etc/mortise/authority.pem",
                           .processes = {{"catalog", 43, "127.0.0.1:7701", 2, true}}};
  ASSERT_TRUE(WriteRunningHouse(folder_, house).ok());
  const RunningHouse read = ReadRunningHouse(folder_).value();
  EXPECT_EQ(read.launcher, 42);
  EXPECT_EQ(read.gateway_grpc, house.gateway_grpc);
  EXPECT_EQ(read.gateway_http, house.gateway_http);
  EXPECT_TRUE(read.plain_text);
  EXPECT_EQ(read.authority, house.authority);
  ASSERT_EQ(read.processes.size(), 1u);
  EXPECT_EQ(read.processes[0].name, "catalog");
  EXPECT_EQ(read.processes[0].restarts, 2);
  EXPECT_TRUE(read.processes[0].serving);
}

TEST_F(StateFolderTest, TornHouseFileIsSaidToBe) {
  ASSERT_TRUE(WriteFile(folder_ / "house.json", "{\"launcher\": 4").ok());
  EXPECT_EQ(ReadRunningHouse(folder_).status().code(), absl::StatusCode::kDataLoss);
}

}  // namespace
}  // namespace mortise::cli
