// Designs with choices that ship, by the command line: what of them is there, Table 8.2 of the
// thesis as the manual shows it, and a shed of 1,333 pegs with a guide that people can read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/files.h"
#include "tests/e2e/command.h"
#include "tests/e2e/running_house.h"
#include "tests/support/temporary_folder.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::absolute(folder == nullptr ? "." : folder);
}

class CarpentryTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<RunningHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  void SetUp() override { ASSERT_TRUE(house_->Serving()) << house_->Log(); }

  static CommandResult Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--gateway", house_->GrpcAddress()});
    return Mortise(arguments);
  }

  // What a person is told of a design at parameters, "legs=panels" and the like.
  static std::string Told(const std::string& design, const std::vector<std::string>& values) {
    std::vector<std::string> arguments = {"catalog", "evaluate", design};
    for (const std::string& value : values) arguments.insert(arguments.end(), {"--set", value});
    const CommandResult result = Run(std::move(arguments));
    EXPECT_EQ(result.exit_code, 0) << result.out << result.error;
    return result.out;
  }

  static std::unique_ptr<RunningHouse> house_;
};

std::unique_ptr<RunningHouse> CarpentryTest::house_;

TEST_F(CarpentryTest, LeavesOutWhatIsNotChosen) {
  EXPECT_THAT(Told("shed", {"window=one"}), HasSubstr("without front_wall"));
  EXPECT_THAT(Told("shed", {"shelving=none", "slabs=23"}), HasSubstr("slab: 23"));
  EXPECT_THAT(Told("work-table", {"legs=panels", "lower=none"}), HasSubstr("without post"));
  EXPECT_THAT(Told("writing-desk", {"pedestal=none"}), HasSubstr("without partition"));
}

TEST_F(CarpentryTest, FollowsLengths) {
  EXPECT_THAT(Told("platform-bed", {"width=1.1m"}), HasSubstr("without middle_beam"));
  EXPECT_THAT(Told("platform-bed", {"width=1.3m"}), Not(HasSubstr("without middle_beam")));
  EXPECT_THAT(Told("work-table", {"length=1.1m", "slat_pitch=0.2"}), HasSubstr("slat: 5"));
  EXPECT_THAT(Told("work-table", {"length=1.1m", "slat_pitch=0.1"}), HasSubstr("slat: 10"));
}

TEST_F(CarpentryTest, CountsAsTheManualShowsBesideTheThesis) {
  const testing::TemporaryFolder folder;
  const CommandResult table =
      Shell(absl::StrCat("MORTISE_GATEWAY=", house_->GrpcAddress(), " python3 '",
                         (Source() / "tools/designs/table_8_2.py").string(), "'"),
            folder.path());
  EXPECT_EQ(table.exit_code, 0) << table.out << table.error;
  const auto manual = ReadFile(Source() / "docs/carpentry.md");
  ASSERT_TRUE(manual.ok()) << manual.status();
  const std::vector<std::string> lines = absl::StrSplit(table.out, '\n', absl::SkipEmpty());
  EXPECT_EQ(lines.size(), 11u);
  for (const std::string& line : lines) EXPECT_THAT(*manual, HasSubstr(line));
}

TEST_F(CarpentryTest, TellsHowToBuildAShedOfManyPegs) {
  const testing::TemporaryFolder folder;
  const CommandResult planned =
      Run({"--json", "plan", "shed", "--set", "width=1.98", "--set", "depth=2.4", "--set",
           "height=2.18", "--set", "door_width=0.75", "--out", folder.path().string()});
  ASSERT_EQ(planned.exit_code, 0) << planned.out << planned.error;
  const Json plan = Json::parse(planned.out, nullptr, false);
  EXPECT_EQ(plan["pegs"], 1333);
  EXPECT_EQ(plan["holes"].size(), 2u * 1333u);
  // Alike joints are told once: no step takes a page.
  ASSERT_EQ(plan["steps"].size(), 9u);
  for (const Json& step : plan["steps"]) {
    EXPECT_LT(step["instruction"].get<std::string>().size(), 500u) << step["number"];
    EXPECT_TRUE(std::filesystem::exists(folder.path() /
                                        absl::StrCat("step-", step["number"].get<int>(), ".png")));
  }
  EXPECT_LT(std::filesystem::file_size(folder.path() / "assembly-guide.html"), 2'000'000u);
}

}  // namespace
}  // namespace mortise::e2e
