#include "common/base/files.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/identifiers.h"

namespace mortise {
namespace {

class FilesTest : public testing::Test {
 protected:
  FilesTest() : folder_(std::filesystem::path(testing::TempDir()) / NewIdentifier()) {
    std::filesystem::create_directories(folder_);
  }
  ~FilesTest() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_;
};

TEST_F(FilesTest, ReadsBackWhatWasWritten) {
  const std::string bytes("a\0b\n\xff", 5);
  ASSERT_TRUE(WriteFile(folder_ / "deep/er/file", bytes).ok());
  EXPECT_EQ(ReadFile(folder_ / "deep/er/file").value(), bytes);
}

TEST_F(FilesTest, ReplacesWholeFilesAndLeavesNothingBeside) {
  ASSERT_TRUE(WriteFile(folder_ / "file", std::string(100, 'x')).ok());
  ASSERT_TRUE(WriteFile(folder_ / "file", "short").ok());
  EXPECT_EQ(ReadFile(folder_ / "file").value(), "short");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(FilesTest, MissingFileIsNotFoundAndNamed) {
  const absl::Status status = ReadFile(folder_ / "none").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_NE(status.message().find("none"), absl::string_view::npos);
}

TEST_F(FilesTest, RefusesFilesPastTheLimit) {
  ASSERT_TRUE(WriteFile(folder_ / "file", "12345").ok());
  EXPECT_EQ(ReadFile(folder_ / "file", 4).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST_F(FilesTest, FoldersAreToldFromLargeFiles) {
  const absl::Status status = ReadFile(folder_, 4).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), folder_.string() + " is a folder, not a file");
}

TEST_F(FilesTest, ExtensionsMeanTheSameInEitherCase) {
  EXPECT_EQ(LowerCaseExtension("folder.D/Items.CSV"), ".csv");
  EXPECT_EQ(LowerCaseExtension("part.Step"), ".step");
  EXPECT_EQ(LowerCaseExtension("none"), "");
}

TEST_F(FilesTest, WritingUnderAFileFailsAndNamesThePath) {
  ASSERT_TRUE(WriteFile(folder_ / "file", "x").ok());
  const absl::Status status = WriteFile(folder_ / "file" / "below", "y");
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message().find("file"), absl::string_view::npos);
}

}  // namespace
}  // namespace mortise
