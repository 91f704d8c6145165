// Which files make room for others.
#include "common/host/file_quota.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "common/base/errors.h"
#include "common/operations/operations.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"
#include "tests/support/temporary_folder.h"

namespace mortise::rpc {
namespace {

class FileQuotaTest : public ::testing::Test {
 protected:
  // A file of 1000 bytes, so old.
  std::string Write(char content, std::chrono::minutes age) {
    const std::string digest = blobs_->Put(std::string(1000, content)).value();
    std::filesystem::last_write_time(blobs_->PathOf(digest).value(),
                                     std::filesystem::file_time_type::clock::now() - age);
    return digest;
  }

  NamedFiles Named() {
    return {.by_store = [this](store::ReadTransaction&, std::set<std::string>* named) {
      named->insert(named_);
      return absl::OkStatus();
    }};
  }

  bool Exists(const std::string& digest) { return blobs_->Size(digest).ok(); }

  std::string named_;  // a file that something refers to
  const mortise::testing::TemporaryFolder folder_;
  const std::filesystem::path blob_folder_ = folder_.path() / "blobs";
  const std::unique_ptr<store::Store> store_ =
      store::OpenStore(
          {.url = "sqlite:" + (folder_.path() / "store.db").string(), .blob_folder = blob_folder_})
          .value();
  store::BlobFolder* const blobs_ = store_->Blobs().value();
  const std::unique_ptr<operations::Operations> operations_ =
      operations::Operations::Create({.service = "files"}, store_.get()).value();
};

TEST_F(FileQuotaTest, LetsTheOldestGoFirst) {
  const std::string newest = Write('c', std::chrono::minutes(5));
  const std::string oldest = Write('a', std::chrono::minutes(50));
  const std::string middle = Write('b', std::chrono::minutes(20));
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 3500, "file-disk-quota");
  EXPECT_TRUE(quota.MakeRoom(500).ok());
  EXPECT_TRUE(Exists(oldest)) << "there was room";
  EXPECT_TRUE(quota.MakeRoom(1400).ok());
  EXPECT_FALSE(Exists(oldest));
  EXPECT_TRUE(Exists(middle));
  // What is fetched or named again is as new as what was just written.
  ASSERT_TRUE(store::TouchBlob(*blobs_, middle).ok());
  EXPECT_TRUE(quota.MakeRoom(2400).ok());
  EXPECT_FALSE(Exists(newest));
  EXPECT_TRUE(Exists(middle));
}

TEST_F(FileQuotaTest, KeepsWhatIsNamedOrHasJustCome) {
  named_ = Write('a', std::chrono::minutes(50));
  const std::string young = Write('b', std::chrono::minutes(0));
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2500, "file-disk-quota");
  const absl::Status full = quota.MakeRoom(600).status();
  EXPECT_TRUE(absl::IsResourceExhausted(full)) << full;
  EXPECT_EQ(DetailOf(full).reason, "FILE_QUOTA");
  EXPECT_NE(full.message().find("--file-disk-quota"), absl::string_view::npos) << full;
  EXPECT_TRUE(Exists(named_));
  EXPECT_TRUE(Exists(young));
  EXPECT_TRUE(quota.MakeRoom(500).ok());
}

TEST_F(FileQuotaTest, HoldsRoomForWhatIsBeingWritten) {
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2000, "file-disk-quota");
  auto first = quota.MakeRoom(1500);
  ASSERT_TRUE(first.ok());
  EXPECT_FALSE(quota.MakeRoom(1000).ok());
  first->reset();  // it broke off
  auto second = quota.MakeRoom(1000);
  ASSERT_TRUE(second.ok());
  Write('a', std::chrono::minutes(0));
  (*second)->Keep();
  second->reset();
  EXPECT_FALSE(quota.MakeRoom(1500).ok());
  EXPECT_TRUE(quota.MakeRoom(1000).ok());
}

TEST_F(FileQuotaTest, SaysWhereThereWillNeverBeRoom) {
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2000, "file-disk-quota");
  const absl::Status beyond = quota.MakeRoom(2001).status();
  EXPECT_TRUE(absl::IsResourceExhausted(beyond)) << beyond;
  EXPECT_EQ(DetailOf(beyond).reason, "FILE_BEYOND_QUOTA");
}

}  // namespace
}  // namespace mortise::rpc
