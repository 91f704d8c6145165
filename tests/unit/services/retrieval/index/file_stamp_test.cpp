// Whether what happened to a file is seen.
#include "services/retrieval/index/file_stamp.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/base/files.h"
#include "tests/support/temporary_folder.h"

namespace mortise::retrieval {
namespace {

TEST(FileStamp, StaysWhileNobodyTouchesTheFile) {
  const mortise::testing::TemporaryFolder folder;
  const auto path = folder.path() / "file";
  ASSERT_TRUE(WriteFile(path, "content").ok());
  const FileStamp stamp = StampOf(path);
  EXPECT_NE(stamp, FileStamp());
  EXPECT_EQ(*ReadFile(path), "content");
  EXPECT_EQ(StampOf(path), stamp);
}

TEST(FileStamp, ChangesWithTheFile) {
  const mortise::testing::TemporaryFolder folder;
  const auto path = folder.path() / "file";
  ASSERT_TRUE(WriteFile(path, "content").ok());
  const FileStamp stamp = StampOf(path);
  ASSERT_TRUE(WriteFile(folder.path() / "other", "content").ok());
  std::filesystem::rename(folder.path() / "other", path);
  EXPECT_NE(StampOf(path), stamp) << "another file";
  std::filesystem::resize_file(path, 3);
  EXPECT_NE(StampOf(path).bytes, stamp.bytes);
  std::filesystem::remove(path);
  EXPECT_EQ(StampOf(path), FileStamp());
}

}  // namespace
}  // namespace mortise::retrieval
