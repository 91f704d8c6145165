// Which files make room for others.
#include "common/host/file_quota.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/base/errors.h"
#include "common/operations/operations.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"
#include "tests/support/status_assertions.h"
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
  EXPECT_OK(FileQuota::Room(&quota).Grow(500));
  EXPECT_TRUE(Exists(oldest)) << "there was room";
  EXPECT_OK(FileQuota::Room(&quota).Grow(1400));
  EXPECT_FALSE(Exists(oldest));
  EXPECT_TRUE(Exists(middle));
  // What is fetched or named again is as new as what was just written.
  ASSERT_TRUE(store::TouchBlob(*blobs_, middle).ok());
  EXPECT_OK(FileQuota::Room(&quota).Grow(2400));
  EXPECT_FALSE(Exists(newest));
  EXPECT_TRUE(Exists(middle));
}

TEST_F(FileQuotaTest, KeepsWhatIsNamedOrHasJustCome) {
  named_ = Write('a', std::chrono::minutes(50));
  const std::string young = Write('b', std::chrono::minutes(0));
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2500, "file-disk-quota");
  const absl::Status full = FileQuota::Room(&quota).Grow(600);
  EXPECT_TRUE(absl::IsResourceExhausted(full)) << full;
  EXPECT_EQ(DetailOf(full).reason, "FILE_QUOTA");
  EXPECT_NE(full.message().find("--file-disk-quota"), absl::string_view::npos) << full;
  EXPECT_TRUE(Exists(named_));
  EXPECT_TRUE(Exists(young));
  EXPECT_OK(FileQuota::Room(&quota).Grow(500));
}

TEST_F(FileQuotaTest, HoldsRoomForWhatIsBeingWritten) {
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2000, "file-disk-quota");
  {
    FileQuota::Room breaks_off(&quota);
    EXPECT_OK(breaks_off.Grow(1000));
    EXPECT_OK(breaks_off.Grow(500));
    EXPECT_FALSE(FileQuota::Room(&quota).Grow(1000).ok());
  }
  {
    FileQuota::Room room(&quota);
    ASSERT_OK(room.Grow(1000));
    Write('a', std::chrono::minutes(0));
    room.Keep(/*is_new=*/true);
  }
  EXPECT_FALSE(FileQuota::Room(&quota).Grow(1500).ok());
  EXPECT_OK(FileQuota::Room(&quota).Grow(1000));
}

// Uploads that only say how large they will be hold nothing yet.
TEST_F(FileQuotaTest, TakesNothingForWhatIsOnlyAnnounced) {
  const std::string others = Write('a', std::chrono::minutes(50));
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2000, "file-disk-quota");
  std::list<FileQuota::Room> idle;
  for (int i = 0; i < 100; ++i) {
    ASSERT_OK(quota.CheckSize(2000));
    ASSERT_OK(idle.emplace_back(&quota).Grow(0));
  }
  EXPECT_OK(FileQuota::Room(&quota).Grow(1000));
  EXPECT_TRUE(Exists(others));
}

// What a file takes that came again counts once: there seems to be room still, so that nobody looks
// and sees what others have written.
TEST_F(FileQuotaTest, CountsAFileThatWasThereOnce) {
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 3000, "file-disk-quota");
  for (int time = 0; time < 10; ++time) {
    FileQuota::Room room(&quota);
    ASSERT_OK(room.Grow(1000));
    Write('a', std::chrono::minutes(50));
    room.Keep(/*is_new=*/time == 0);
  }
  const std::string others = Write('b', std::chrono::minutes(40));
  EXPECT_OK(FileQuota::Room(&quota).Grow(2000));
  EXPECT_TRUE(Exists(others));
}

// The files are counted once, and then only where room is lacking.
TEST_F(FileQuotaTest, LooksAtTheFilesOnlyWhereRoomIsLacking) {
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 5000, "file-disk-quota");
  ASSERT_OK(FileQuota::Room(&quota).Grow(1));
  // Another process writes what is not counted before the next look.
  Write('a', std::chrono::minutes(50));
  FileQuota::Room room(&quota);
  for (int i = 0; i < 50; ++i) EXPECT_OK(room.Grow(100)) << i;
  EXPECT_OK(FileQuota::Room(&quota).Grow(0));
  EXPECT_FALSE(FileQuota::Room(&quota).Grow(1).ok());
}

TEST_F(FileQuotaTest, ManyAtOnceTakeNoMoreThanThereIs) {
  for (char content = 'a'; content < 'k'; ++content) Write(content, std::chrono::minutes(50));
  FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 10'000,
                  "file-disk-quota");
  std::atomic<int> taken = 0;
  std::list<FileQuota::Room> rooms;
  std::vector<std::thread> uploads;
  for (int i = 0; i < 8; ++i) {
    uploads.emplace_back([&taken, &room = rooms.emplace_back(&quota)] {
      for (int chunk = 0; chunk < 20; ++chunk) {
        if (room.Grow(100).ok()) ++taken;
      }
    });
  }
  for (std::thread& upload : uploads) upload.join();
  EXPECT_EQ(taken, 100) << "all files could go, and no more than the quota";
}

TEST_F(FileQuotaTest, SaysWhereThereWillNeverBeRoom) {
  const FileQuota quota(store_.get(), operations_.get(), blob_folder_, Named(), 2000,
                        "file-disk-quota");
  EXPECT_OK(quota.CheckSize(2000));
  const absl::Status beyond = quota.CheckSize(2001);
  EXPECT_TRUE(absl::IsResourceExhausted(beyond)) << beyond;
  EXPECT_EQ(DetailOf(beyond).reason, "FILE_BEYOND_QUOTA");
}

}  // namespace
}  // namespace mortise::rpc
