// The armchair that ships, by the command line: with armrests and without, evaluated, planned and
// analysed; its fronts over the choice; and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/files.h"
#include "tests/e2e/command.h"
#include "tests/e2e/running_house.h"
#include "tests/support/temporary_folder.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

class ArmchairTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<RunningHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  void SetUp() override { ASSERT_TRUE(house_->Serving()) << house_->Log(); }

  static CommandResult Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--gateway", house_->GrpcAddress()});
    return Mortise(arguments);
  }

  // Runs a command with --json that must succeed, and takes its document.
  static Json Ask(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "--json");
    const CommandResult result = Run(std::move(arguments));
    EXPECT_EQ(result.exit_code, 0) << result.out << result.error;
    return Json::parse(result.out, nullptr, false);
  }

  static std::set<std::string> NamesOf(const Json& parts) {
    std::set<std::string> names;
    for (const Json& part : parts) names.insert(part["name"].get<std::string>());
    return names;
  }

  static std::unique_ptr<RunningHouse> house_;
};

std::unique_ptr<RunningHouse> ArmchairTest::house_;

TEST_F(ArmchairTest, HasArmrestsOrNone) {
  const Json both = Ask({"catalog", "evaluate", "armchair", "--set", "armrests=both"});
  const Json none =
      Ask({"catalog", "evaluate", "armchair", "--set", "armrests=none", "--set", "wood=beech"});
  EXPECT_EQ(both["parts"].size(), 14u);
  EXPECT_EQ(none["parts"].size(), 12u);
  EXPECT_TRUE(NamesOf(both["parts"]).contains("arm 2"));
  EXPECT_FALSE(NamesOf(none["parts"]).contains("arm 1"));
  EXPECT_EQ(none["parameters"][0]["choice"], "none");
  EXPECT_EQ(both["parameters"][0]["value"], 1);
  EXPECT_EQ(none["structure"]["absent_parts"], Json::array({"arm"}));
  EXPECT_EQ(none["structure"]["absent_conditions"], Json::array({"arms"}));
  EXPECT_NE(both["structure"]["key"], none["structure"]["key"]);
  for (const Json& part : none["parts"]) {
    EXPECT_THAT(part["item"].get<std::string>(), HasSubstr("beech"));
  }
  const CommandResult told = Run({"catalog", "evaluate", "armchair", "--set", "armrests=none"});
  EXPECT_THAT(told.out, HasSubstr("structure: armrests = none, wood = spruce, without arm"));
}

TEST_F(ArmchairTest, IsPlannedWithOneStepLessWithoutArmrests) {
  const Json both = Ask({"plan", "armchair", "--set", "armrests=both"});
  const testing::TemporaryFolder folder;
  const Json none =
      Ask({"plan", "armchair", "--set", "armrests=none", "--out", folder.path().string()});
  EXPECT_EQ(both["jigsaw_parts"], 4);
  EXPECT_EQ(none["jigsaw_parts"], 4);
  EXPECT_EQ(both["chop_saw_parts"], 10);
  EXPECT_EQ(none["chop_saw_parts"], 8);
  EXPECT_EQ(both["steps"].size(), 5u);
  EXPECT_EQ(none["steps"].size(), 4u);
  EXPECT_EQ(both["pegs"], 64);
  EXPECT_EQ(none["pegs"], 48);
  EXPECT_EQ(none["parameters"][0]["choice"], "none");
  // What is absent is nowhere in the plan.
  EXPECT_THAT(none.dump(), ::testing::Not(HasSubstr("\"arm ")));
  for (const char* file : {"cut-list.csv", "holes.csv", "assembly-guide.html"}) {
    const auto text = ReadFile(folder.path() / file);
    ASSERT_TRUE(text.ok()) << file;
    EXPECT_THAT(*text, ::testing::Not(HasSubstr("Armrest"))) << file;
  }
}

TEST_F(ArmchairTest, BearsWhoSitsInIt) {
  const std::vector<std::string> coarse = {"analyze",          "armchair", "--metric",
                                           "max_displacement", "--metric", "mass",
                                           "--element-size",   "60mm",     "--linear"};
  double mass = 0;
  for (const char* arms : {"armrests=none", "armrests=both"}) {
    std::vector<std::string> arguments = coarse;
    arguments.insert(arguments.end(), {"--set", arms});
    const Json analysis = Ask(arguments);
    const double sag = analysis["metrics"][0]["value"].get<double>();
    EXPECT_GT(sag, 1e-6) << arms;
    EXPECT_LT(sag, 0.02) << arms;
    EXPECT_GT(analysis["metrics"][1]["value"].get<double>(), mass);
    mass = analysis["metrics"][1]["value"].get<double>();
  }
}

TEST_F(ArmchairTest, IsTradedOffOverItsChoices) {
  const Json front = Ask({"pareto", "run", "armchair", "--minimize", "mass", "--minimize", "cost",
                          "--fix", "splats=2", "--evaluations", "60", "--seed", "3"});
  ASSERT_GT(front["points"].size(), 0u);
  std::set<std::string> woods;
  for (const Json& point : front["points"]) {
    EXPECT_EQ(point["choices"][0], "none");  // armrests weigh and cost
    woods.insert(point["choices"][1].get<std::string>());
  }
  EXPECT_TRUE(woods.contains("spruce"));
}

TEST_F(ArmchairTest, SaysWhatItCannotBe) {
  const auto refusal = [](const std::string& set) {
    const CommandResult result = Run({"catalog", "evaluate", "armchair", "--set", set});
    EXPECT_NE(result.exit_code, 0) << set;
    return result.out + result.error;
  };
  EXPECT_THAT(refusal("armrests=left"),
              HasSubstr("'armrests' has no value 'left'; it has 'none', 'both'"));
  EXPECT_THAT(refusal("armrests=0.5"), HasSubstr("not the number of one of its 2 values"));
  EXPECT_THAT(refusal("width=both"), HasSubstr("'width' is a number, no choice"));
  // Evaluating rounds to what a workshop can set; analyses take parameters as they are.
  const CommandResult halved =
      Run({"analyze", "armchair", "--metric", "mass", "--set", "splats=2.5"});
  EXPECT_NE(halved.exit_code, 0);
  EXPECT_THAT(halved.out + halved.error, HasSubstr("no whole number"));
}

}  // namespace
}  // namespace mortise::e2e
