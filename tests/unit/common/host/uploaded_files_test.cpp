// Uploaded files: how many there may be, whatever their size, and when they go. What they are as
// bytes: tests/unit/services/catalog/records/drawing_records_test.cpp.
#include "common/host/uploaded_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "mortise/v1/types.pb.h"
#include "tests/support/temporary_folder.h"

namespace mortise::rpc {
namespace {

class UploadedFilesTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::string> Upload(const std::string& bytes) {
    IncomingFile file(store_.get(), blobs_, kind_);
    v1::Chunk chunk;
    chunk.set_data(bytes);
    chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    MORTISE_RETURN_IF_ERROR(file.Append(chunk));
    return file.Keep();
  }

  bool IsThere(const std::string& sha256) {
    return GetUploaded(*store_, blobs_, kind_, sha256).ok();
  }

  void Tidy() { TidyUploads(*store_, blobs_, blob_folder_, kind_); }

  int FilesOfBlobs() const {
    int files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(blob_folder_)) {
      if (entry.is_regular_file()) ++files;
    }
    return files;
  }

  testing::TemporaryFolder folder_;
  const std::filesystem::path blob_folder_ = folder_.path() / "blobs";
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string()),
                        .blob_folder = blob_folder_,
                        .clock = [this] { return now_; }})
          .value();
  store::BlobFolder* const blobs_ = store_->Blobs().value();
  UploadedKind kind_{.records = "sketches",
                     .field = "sketch",
                     .full_reason = "SKETCHES_FULL",
                     .most_in_one = 100,
                     .most_together = 1000,
                     .most_files = 3};
};

TEST_F(UploadedFilesTest, AreBoundedInNumberHoweverSmall) {
  for (const char* bytes : {"", "a", "b"}) {
    ASSERT_TRUE(Upload(bytes).ok()) << bytes;
    now_ += absl::Minutes(10);
  }
  const absl::Status full = Upload("c").status();
  EXPECT_EQ(full.code(), absl::StatusCode::kResourceExhausted) << full;
  EXPECT_EQ(DetailOf(full).reason, "SKETCHES_FULL");
  EXPECT_NE(full.message().find("3 of 3"), std::string::npos) << full;
  EXPECT_NE(full.message().find("in 30m"), std::string::npos) << full;
  EXPECT_EQ(FilesOfBlobs(), 3);
  EXPECT_TRUE(Upload("b").ok()) << "it is there already";
}

TEST_F(UploadedFilesTest, TheOldestMakeRoomOnceTheirGraceIsOver) {
  const std::string first = *Upload("a");
  now_ += absl::Minutes(10);
  const std::string second = *Upload("b"), third = *Upload("c");
  ASSERT_FALSE(Upload("d").ok());
  now_ += absl::Minutes(51);
  const auto fourth = Upload("d");
  ASSERT_TRUE(fourth.ok()) << fourth.status();
  EXPECT_FALSE(IsThere(first));
  EXPECT_TRUE(IsThere(second) && IsThere(third) && IsThere(*fourth));
  EXPECT_FALSE(Upload("e").ok());
}

TEST_F(UploadedFilesTest, SayWhenThereWillBeRoomForTheirBytes) {
  kind_.most_together = 150;
  ASSERT_TRUE(Upload(std::string(100, 'a')).ok());
  now_ += absl::Minutes(40);
  const absl::Status full = Upload(std::string(60, 'b')).status();
  EXPECT_EQ(DetailOf(full).reason, "SKETCHES_FULL") << full;
  EXPECT_EQ(DetailOf(full).field, "total_size");
  EXPECT_NE(full.message().find("100 of 150 bytes"), std::string::npos) << full;
  EXPECT_NE(full.message().find("in 20m"), std::string::npos) << full;
  now_ += absl::Minutes(20) + absl::Seconds(1);
  EXPECT_TRUE(Upload(std::string(60, 'b')).ok());
}

TEST_F(UploadedFilesTest, AreTidiedAwayWhenTheyHaveOutlivedTheirKind) {
  kind_.life = absl::Hours(2);
  const std::string first = *Upload("a");
  now_ += absl::Hours(1);
  const std::string second = *Upload("b");
  Tidy();
  EXPECT_TRUE(IsThere(first) && IsThere(second));
  now_ += absl::Hours(1) + absl::Seconds(1);
  Tidy();
  EXPECT_FALSE(IsThere(first));
  EXPECT_TRUE(IsThere(second));
  EXPECT_EQ(FilesOfBlobs(), 1);
}

TEST_F(UploadedFilesTest, WhatBrokeOffLongAgoIsTidiedAway) {
  IncomingFile died(store_.get(), blobs_, kind_);
  v1::Chunk chunk;
  chunk.set_data("half");
  chunk.set_total_size(8);
  ASSERT_TRUE(died.Append(chunk).ok());
  Tidy();
  EXPECT_EQ(FilesOfBlobs(), 1);
  for (const auto& part : std::filesystem::directory_iterator(blob_folder_ / "parts")) {
    std::filesystem::last_write_time(
        part, std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
  }
  Tidy();
  EXPECT_EQ(FilesOfBlobs(), 0);
}

}  // namespace
}  // namespace mortise::rpc
