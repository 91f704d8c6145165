// What belongs to which query of `mortise search`, and files that are none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/commands/command_line.h"
#include "common/base/files.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;

// What is said of `mortise search ARGUMENTS`; empty if nothing is wrong. Nothing is run.
std::string Refusal(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "search");
  CLI::App app;
  Session session;
  BuildCommandLine(app, session);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    return "";
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

TEST(SearchCommand, FlagsOfADesignAreRefusedWithAFile) {
  EXPECT_THAT(Refusal({"table.glb", "--part", "top"}), HasSubstr("--part"));
  EXPECT_THAT(Refusal({"table.glb", "--set", "length=1m"}), HasSubstr("--set"));
  EXPECT_EQ(Refusal({"--design", "table", "--set", "length=1m", "--part", "top"}), "");
}

TEST(SearchCommand, FlagsOfAFileAreRefusedWithADesign) {
  EXPECT_THAT(Refusal({"--design", "table", "--unit", "mm"}), HasSubstr("--unit"));
  EXPECT_THAT(Refusal({"--design", "table", "--up", "y"}), HasSubstr("--up"));
  EXPECT_EQ(Refusal({"table.glb", "--unit", "mm", "--up", "y"}), "");
}

TEST(SearchCommand, AnEmptyFileIsCalledEmpty) {
  const mortise::testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "nothing.obj";
  ASSERT_TRUE(WriteFile(file, "").ok());
  Output output(Output::Form::kSilent);
  const absl::Status refused = RunCommandLine({"search", file.string()}, Session(), output);
  EXPECT_THAT(refused.message(), HasSubstr(file.string() + ": is empty"));
}

}  // namespace
}  // namespace mortise::cli
