// Blobs that nobody refers to go, and no other, whoever writes and touches them meanwhile.
#include "common/store/blob_upkeep.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "common/base/digest.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::store {
namespace {

bool IsNotUsed(const std::string&) { return false; }

class BlobUpkeepTest : public ::testing::Test {
 protected:
  std::string PutAged(const std::string& bytes, absl::Duration age) {
    const std::string digest = blobs_->Put(bytes).value();
    Age(blobs_->PathOf(digest).value(), age);
    return digest;
  }

  static void Age(const std::filesystem::path& path, absl::Duration age) {
    const auto nanoseconds = std::chrono::nanoseconds(absl::ToInt64Nanoseconds(age));
    std::filesystem::last_write_time(path,
                                     std::filesystem::file_time_type::clock::now() - nanoseconds);
  }

  bool Exists(const std::string& digest) { return blobs_->Size(digest).ok(); }

  const testing::TemporaryFolder folder_;
  const std::unique_ptr<BlobFolder> blobs_ = BlobFolder::Open(folder_.path()).value();
  const absl::Time hour_ago_ = absl::Now() - absl::Hours(1);
};

TEST_F(BlobUpkeepTest, WhatIsOldAndUnusedGoes) {
  const std::string old = PutAged("old", absl::Hours(2));
  const std::string used = PutAged("used", absl::Hours(2));
  const std::string young = PutAged("young", absl::Minutes(30));
  const std::string touched = PutAged("touched", absl::Hours(2));
  EXPECT_OK(TouchBlob(*blobs_, touched));
  const auto removed = RemoveUnusedBlobs(folder_.path(), hour_ago_,
                                         [&](const std::string& digest) { return digest == used; });
  ASSERT_OK(removed);
  EXPECT_EQ(removed->count, 1);
  EXPECT_EQ(removed->bytes, 3);
  EXPECT_FALSE(Exists(old));
  for (const std::string& digest : {used, young, touched}) EXPECT_TRUE(Exists(digest));
  EXPECT_EQ(TouchBlob(*blobs_, old).code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(TouchBlob(*blobs_, "old").code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(BlobUpkeepTest, WhatIsWrittenOrTouchedMeanwhileStays) {
  const std::string touched = PutAged("touched", absl::Hours(2));
  const std::string written = PutAged("written", absl::Hours(2));
  // It is asked when the blob has been found to be old, and before it goes.
  const auto removed = RemoveUnusedBlobs(folder_.path(), hour_ago_, [&](const std::string& digest) {
    if (digest == touched) {
      EXPECT_OK(TouchBlob(*blobs_, touched));
    }
    if (digest != written) return false;
    auto writer = blobs_->Write();
    EXPECT_OK(writer);
    EXPECT_OK((*writer)->Append("written"));
    EXPECT_OK((*writer)->Finish());
    return false;
  });
  ASSERT_OK(removed);
  EXPECT_EQ(removed->count, 0);
  EXPECT_EQ(blobs_->Get(touched).value(), "touched");
  EXPECT_EQ(blobs_->Get(written).value(), "written");
}

TEST_F(BlobUpkeepTest, NoUploadIsLostBesideRemovals) {
  for (int round = 0; round < 200; ++round) {
    const std::string digest = PutAged("again and again", absl::Hours(2));
    std::thread upload([&] {
      auto writer = blobs_->Write();
      EXPECT_OK(writer);
      EXPECT_OK((*writer)->Append("again and again"));
      EXPECT_OK((*writer)->Finish());
    });
    std::thread other(
        [&] { EXPECT_OK(RemoveUnusedBlobs(folder_.path(), hour_ago_, IsNotUsed).status()); });
    EXPECT_OK(RemoveUnusedBlobs(folder_.path(), hour_ago_, IsNotUsed).status());
    upload.join();
    other.join();
    ASSERT_TRUE(Exists(digest)) << "round " << round;
  }
}

}  // namespace
}  // namespace mortise::store
