// Uploaded drawings: kept as they came, nothing left of those that broke off, forgotten in time.
#include "services/catalog/records/drawing_records.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/step/step_reader.h"
#include "services/catalog/records/upkeep.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

class DrawingRecordsTest : public ::testing::Test {
 protected:
  static v1::Chunk ChunkOf(const std::string& bytes, std::size_t offset, std::size_t length) {
    v1::Chunk chunk;
    chunk.set_offset(static_cast<int64_t>(offset));
    chunk.set_data(bytes.substr(offset, length));
    if (offset == 0) chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    return chunk;
  }

  // Sends bytes in two pieces; its digest.
  absl::StatusOr<std::string> Upload(const std::string& bytes, const std::string& sha256 = "",
                                     int64_t most = kMaxDrawingBytes) {
    const auto reader = ReceiveDrawing(store_.get(), blobs_, most);
    const std::size_t half = bytes.size() / 2;
    v1::Chunk first = ChunkOf(bytes, 0, half);
    first.set_sha256(sha256);
    MORTISE_RETURN_IF_ERROR(reader->OnMessage(first));
    MORTISE_RETURN_IF_ERROR(reader->OnMessage(ChunkOf(bytes, half, bytes.size() - half)));
    MORTISE_ASSIGN_OR_RETURN(const v1::UploadDrawingResponse response, reader->Complete());
    return response.sha256();
  }

  absl::StatusOr<std::string> Get(const std::string& sha256) {
    return GetDrawing(store_.get(), blobs_, sha256);
  }

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
};

TEST_F(DrawingRecordsTest, AreKeptAsTheyCame) {
  const std::string bytes(3'000, 'x');
  const auto digest = Upload(bytes, Sha256Hex(bytes));
  ASSERT_TRUE(digest.ok()) << digest.status();
  EXPECT_EQ(*digest, Sha256Hex(bytes));
  EXPECT_EQ(Get(*digest).value_or(""), bytes);
  EXPECT_EQ(Upload(bytes).value_or(""), *digest);
  EXPECT_EQ(FilesOfBlobs(), 1);
}

TEST_F(DrawingRecordsTest, LeaveNothingWhereAnUploadBreaksOff) {
  {
    const auto reader = ReceiveDrawing(store_.get(), blobs_);
    ASSERT_TRUE(reader->OnMessage(ChunkOf(std::string(900, 'y'), 0, 300)).ok());
  }
  EXPECT_EQ(FilesOfBlobs(), 0);
  const auto reader = ReceiveDrawing(store_.get(), blobs_);
  ASSERT_TRUE(reader->OnMessage(ChunkOf(std::string(900, 'y'), 0, 300)).ok());
  EXPECT_EQ(DetailOf(reader->Complete().status()).field, "total_size");
}

TEST_F(DrawingRecordsTest, UploadsThatBrokeOffWithTheirProcessGoInADay) {
  const auto died = ReceiveDrawing(store_.get(), blobs_);
  ASSERT_TRUE(died->OnMessage(ChunkOf(std::string(900, 'y'), 0, 300)).ok());
  TidyUp(store_.get(), blobs_, blob_folder_);
  EXPECT_EQ(FilesOfBlobs(), 1);
  for (const auto& part : std::filesystem::directory_iterator(blob_folder_ / "parts")) {
    std::filesystem::last_write_time(
        part, std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
  }
  TidyUp(store_.get(), blobs_, blob_folder_);
  EXPECT_EQ(FilesOfBlobs(), 0);
}

TEST_F(DrawingRecordsTest, LeaveNothingWhereTheDigestDiffers) {
  const std::string bytes(900, 'z');
  EXPECT_EQ(DetailOf(Upload(bytes, std::string(64, '0')).status()).field, "sha256");
  EXPECT_EQ(FilesOfBlobs(), 0);
  // What was there before stays.
  ASSERT_TRUE(Upload(bytes).ok());
  EXPECT_FALSE(Upload(bytes, std::string(64, '0')).ok());
  EXPECT_EQ(Get(Sha256Hex(bytes)).value_or(""), bytes);
}

TEST_F(DrawingRecordsTest, AreRefusedPastTheLimit) {
  const auto reader = ReceiveDrawing(store_.get(), blobs_);
  v1::Chunk chunk;
  chunk.set_data("x");
  chunk.set_total_size(static_cast<int64_t>(cad::kMaxStepBytes) + 1);
  const absl::Status status = reader->OnMessage(chunk);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(status.message().find(std::to_string(cad::kMaxStepBytes)), std::string::npos) << status;
}

TEST_F(DrawingRecordsTest, AreForgottenADayAfterTheyLastCame) {
  const std::string first = *Upload("the first"), second = *Upload("the second");
  now_ += absl::Hours(23);
  ASSERT_TRUE(Upload("the second").ok());
  TidyUp(store_.get(), blobs_, blob_folder_);
  EXPECT_TRUE(Get(first).ok());
  now_ += absl::Hours(2);
  TidyUp(store_.get(), blobs_, blob_folder_);
  EXPECT_EQ(DetailOf(Get(first).status()).field, "drawing");
  EXPECT_EQ(Get(second).value_or(""), "the second");
  EXPECT_EQ(FilesOfBlobs(), 1);
}

TEST_F(DrawingRecordsTest, TheOldestMakeRoomForOthers) {
  constexpr int64_t kMost = 2500;
  const auto upload = [&](char letter) { return Upload(std::string(1000, letter), "", kMost); };
  const auto first = upload('a');
  now_ += absl::Minutes(1);
  const auto second = upload('b');
  ASSERT_TRUE(first.ok() && second.ok());
  // Both are about to be imported.
  const absl::Status full = upload('c').status();
  EXPECT_EQ(full.code(), absl::StatusCode::kResourceExhausted) << full;
  EXPECT_EQ(DetailOf(full).reason, "DRAWINGS_FULL");
  EXPECT_NE(full.message().find("2000 of 2500 bytes"), std::string::npos) << full;
  EXPECT_EQ(FilesOfBlobs(), 2);
  // What is there already takes no more room.
  EXPECT_TRUE(upload('b').ok());
  now_ += kDrawingGrace;
  const auto third = upload('c');
  ASSERT_TRUE(third.ok()) << third.status();
  EXPECT_FALSE(Get(*first).ok());
  EXPECT_TRUE(Get(*second).ok());
  EXPECT_TRUE(Get(*third).ok());
  EXPECT_EQ(FilesOfBlobs(), 2);
  EXPECT_EQ(Upload(std::string(2600, 'd'), "", kMost).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST_F(DrawingRecordsTest, DrawingsOfEarlierVersionsCount) {
  const std::string digest = blobs_->Put(std::string(2000, 'a')).value();
  ASSERT_TRUE(store_
                  ->Transact([&](store::Transaction& transaction) {
                    return transaction.Put("drawings", digest, "").status();
                  })
                  .ok());
  EXPECT_TRUE(Get(digest).ok());
  EXPECT_EQ(DetailOf(Upload(std::string(1000, 'b'), "", 2500).status()).reason, "DRAWINGS_FULL");
  now_ += absl::Hours(2);
  EXPECT_TRUE(Upload(std::string(1000, 'b'), "", 2500).ok());
  EXPECT_FALSE(Get(digest).ok());
}

// A process that dies may leave a record, or with it a blob, but none that nobody knows of.
TEST_F(DrawingRecordsTest, ACrashLeavesNothingThatIsNotForgottenInTime) {
  const std::string bytes(900, 'q'), digest = Sha256Hex(bytes);
  std::filesystem::remove_all(blob_folder_ / digest.substr(0, 2));
  ASSERT_TRUE(WriteFile(blob_folder_ / digest.substr(0, 2), "in the way of the blob").ok());
  EXPECT_FALSE(Upload(bytes).ok());  // between the record and the file
  std::filesystem::remove(blob_folder_ / digest.substr(0, 2));
  EXPECT_EQ(FilesOfBlobs(), 0);
  EXPECT_EQ(DetailOf(Get(digest).status()).field, "drawing");
  const auto records = [&] {
    std::size_t count = 0;
    EXPECT_TRUE(store_
                    ->Read([&](store::ReadTransaction& transaction) -> absl::Status {
                      MORTISE_ASSIGN_OR_RETURN(const auto all, transaction.List("drawings", {}));
                      count = all.size();
                      return absl::OkStatus();
                    })
                    .ok());
    return count;
  };
  EXPECT_EQ(records(), 1u);
  EXPECT_TRUE(Upload(bytes).ok());
  EXPECT_EQ(Get(digest).value_or(""), bytes);
  // Between the file and the record's end, when it is forgotten.
  ASSERT_TRUE(blobs_->Remove(digest).ok());
  now_ += absl::Hours(25);
  TidyUp(store_.get(), blobs_, blob_folder_);
  EXPECT_EQ(records(), 0u);
}

TEST_F(DrawingRecordsTest, AreFoundByDigestOnly) {
  for (const std::string& name :
       {std::string("../store.db"), std::string(64, 'G'), std::string(64, 'a'), std::string()}) {
    const absl::Status status = Get(name).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_EQ(DetailOf(status).field, "drawing");
  }
}

}  // namespace
}  // namespace mortise::catalog
