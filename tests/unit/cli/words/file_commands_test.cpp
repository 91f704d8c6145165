#include "cli/words/file_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class FileCommandsTest : public ::testing::Test {
 protected:
  std::string Written(const std::string& name, const std::string& text = "x") {
    const std::filesystem::path file = folder_.path() / name;
    std::ofstream(file) << text;
    return file.string();
  }

  mortise::testing::TemporaryFolder folder_;
};

TEST_F(FileCommandsTest, KnowsFilesByTheirNamesAndTextsByTheirFirstLines) {
  EXPECT_THAT(UseOf("CHAIR.OBJ").commands, Contains("assembly import"));
  EXPECT_THAT(UseOf("bracket.step").commands, Contains("catalog shape"));
  EXPECT_THAT(UseOf("items.csv").commands, Contains("catalog import"));
  EXPECT_THAT(UseOf("bar.msh").commands, Contains("analyze"));
  EXPECT_THAT(UseOf("photo.jpeg").commands, IsEmpty());
  EXPECT_THAT(
      UseOf(Written("a.textproto", "# proto-message: mortise.v1.Assembly\nname: 'a'")).commands,
      Contains("assembly import"));
  EXPECT_THAT(UseOf(Written("b.textproto", "# proto-message: mortise.v1.CadTemplate\n")).commands,
              Contains("catalog import"));
  EXPECT_THAT(UseOf(Written("c.textproto", "name: 'c'")).commands, IsEmpty());
}

TEST_F(FileCommandsTest, TellsWhichCommandTakesAFileGivenToAnother) {
  const std::string file = Written("chair.obj");
  const absl::Status told = WithRightCommand(
      InvalidField("template", "must be 'templates/' and an id"), "analyze", {file});
  EXPECT_EQ(told.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(told).field, file);
  EXPECT_THAT(std::string(told.message()), HasSubstr("mortise assembly import " + file));
}

TEST_F(FileCommandsTest, LeavesOutWhatElseIsSaidOfTheFileAndKeepsTheRest) {
  const std::string wrong = Written("chair.step");
  const std::string right = Written("bolts.csv");
  const absl::Status told =
      WithRightCommand(InvalidFields({{wrong + ": line 1", "is no text"},
                                      {wrong + ": line 2", "is no text"},
                                      {right + ": line 2, column 3", "'x' is no number"},
                                      {right + ": line 3, column 3", "'y' is no number"}}),
                       "catalog import", {right, wrong});
  EXPECT_THAT(AllViolationsOf(told), SizeIs(3));
  EXPECT_THAT(std::string(told.message()), HasSubstr("mortise catalog shape " + wrong));
  EXPECT_THAT(std::string(told.message()), HasSubstr("column 3"));
  EXPECT_THAT(std::string(told.message()), Not(HasSubstr("is no text")));
}

TEST_F(FileCommandsTest, SaysNothingOfOtherFailuresAndOfFilesThatTheCommandTakes) {
  const std::string file = Written("chair.obj");
  const absl::Status away = absl::UnavailableError("no house");
  EXPECT_EQ(WithRightCommand(away, "analyze", {file}), away);
  const absl::Status invalid = InvalidField("file", "is damaged");
  EXPECT_EQ(WithRightCommand(invalid, "assembly import", {file}), invalid);
  EXPECT_EQ(WithRightCommand(invalid, "analyze", {"table", "not-there.obj"}), invalid);
}

}  // namespace
}  // namespace mortise::cli
