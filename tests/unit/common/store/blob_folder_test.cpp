// Blobs: the same bytes back, half-written ones never seen, damage noticed.
#include "common/store/blob_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::store {
namespace {

class BlobFolderTest : public ::testing::Test {
 protected:
  void SetUp() override { blobs_ = BlobFolder::Open(folder_.path() / "deep" / "blobs").value(); }

  int FilesIn(const std::string& name) {
    int count = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(folder_.path() / "deep" / "blobs" / name)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
    return count;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<BlobFolder> blobs_;
};

TEST_F(BlobFolderTest, TheSameBytesComeBack) {
  for (const std::string& bytes :
       {std::string(), std::string("\0\xFF\n", 3), std::string(3'000'000, 'x')}) {
    const auto digest = blobs_->Put(bytes);
    ASSERT_OK(digest);
    EXPECT_EQ(*digest, Sha256Hex(bytes));
    EXPECT_EQ(blobs_->Get(*digest).value(), bytes);
    EXPECT_EQ(blobs_->Size(*digest).value(), bytes.size());
  }
  EXPECT_EQ(FilesIn("parts"), 0);
}

TEST_F(BlobFolderTest, PiecesMakeTheSameBlob) {
  auto writer = blobs_->Write();
  ASSERT_OK(writer);
  std::string whole;
  for (int i = 0; i < 1000; ++i) {
    const std::string piece = std::to_string(i);
    EXPECT_OK((*writer)->Append(piece));
    whole += piece;
  }
  const auto digest = (*writer)->Finish();
  ASSERT_OK(digest);
  EXPECT_EQ(*digest, Sha256Hex(whole));
  std::string read;
  while (true) {
    const auto piece = blobs_->GetRange(*digest, read.size(), 700);
    ASSERT_OK(piece);
    if (piece->empty()) break;
    read += *piece;
  }
  EXPECT_EQ(read, whole);
  EXPECT_EQ(blobs_->GetRange(*digest, 1 << 20, 10).value(), "");
}

TEST_F(BlobFolderTest, AnAbandonedWriterLeavesNothing) {
  {
    auto writer = blobs_->Write();
    ASSERT_OK(writer);
    EXPECT_OK((*writer)->Append("half"));
    EXPECT_EQ(FilesIn("parts"), 1);
  }
  EXPECT_EQ(FilesIn("parts"), 0);
  EXPECT_EQ(blobs_->Get(Sha256Hex("half")).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(BlobFolderTest, TheDigestIsKnownBeforeTheBlobIsInItsPlace) {
  auto writer = blobs_->Write().value();
  ASSERT_OK(writer->Append("hel"));
  EXPECT_EQ(writer->Digest(), Sha256Hex("hel"));
  ASSERT_OK(writer->Append("lo"));
  const std::string digest = writer->Digest();
  EXPECT_EQ(digest, Sha256Hex("hello"));
  EXPECT_EQ(blobs_->Size(digest).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(writer->Finish().value(), digest);
  EXPECT_EQ(blobs_->Get(digest).value(), "hello");
}

TEST_F(BlobFolderTest, ManyWritersOfTheSameBytesAgree) {
  std::vector<std::thread> writers;
  for (int i = 0; i < 8; ++i) {
    writers.emplace_back([&] {
      for (int k = 0; k < 20; ++k) EXPECT_OK(blobs_->Put("blob " + std::to_string(k)));
    });
  }
  for (std::thread& writer : writers) writer.join();
  for (int k = 0; k < 20; ++k) {
    EXPECT_OK(blobs_->Get(Sha256Hex("blob " + std::to_string(k))));
  }
}

TEST_F(BlobFolderTest, DamageIsNoticed) {
  const std::string digest = blobs_->Put("good").value();
  std::ofstream(blobs_->PathOf(digest).value()) << "evil";
  EXPECT_EQ(blobs_->Get(digest).status().code(), absl::StatusCode::kDataLoss);
}

TEST_F(BlobFolderTest, RemovedIsGone) {
  const std::string digest = blobs_->Put("x").value();
  EXPECT_OK(blobs_->Remove(digest));
  EXPECT_OK(blobs_->Remove(digest));
  EXPECT_EQ(blobs_->Get(digest).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(BlobFolderTest, BadInputIsRefused) {
  for (const char* digest : {"", "ab", "../../../../etc/passwd",
                             "ABCDEF0123456789ABCDEF0123456789ABCDEF0123456789ABCDEF0123456789"}) {
    EXPECT_EQ(DetailOf(blobs_->Get(digest).status()).field, "digest");
    EXPECT_EQ(DetailOf(blobs_->Remove(digest)).field, "digest");
  }
  const std::string digest = blobs_->Put("four").value();
  EXPECT_EQ(blobs_->Get(digest, 3).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST_F(BlobFolderTest, AFolderThatCannotBeMadeIsNamed) {
  const std::filesystem::path file = folder_.path() / "file";
  std::ofstream(file) << "x";
  const absl::Status status = BlobFolder::Open(file / "blobs").status();
  EXPECT_EQ(DetailOf(status).reason, "STORAGE_FAILED");
  EXPECT_NE(status.message().find(file.string()), std::string::npos) << status;
}

}  // namespace
}  // namespace mortise::store
