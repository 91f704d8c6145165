// The assembly guide in a browser: steps are gone through by keys, turned, put together. With
// MORTISE_TEST_OUTPUT set, the pages are kept there to look at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/files.h"
#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/planning/planning.h"
#include "tests/support/opened_page.h"
#include "tests/support/printed_pages.h"
#include "tests/unit/services/fabplanner/example_wall.h"

namespace mortise::fabplanner {
namespace {

using Json = nlohmann::json;
using ::testing::StartsWith;

std::string GuideOf(const Design& design, const Items& items, const std::string& title) {
  const auto plan = MakePlan(design, items, 1);
  EXPECT_TRUE(plan.ok()) << plan.status();
  if (!plan.ok()) return "";
  const auto files =
      MakePlanFiles(*plan, design, items, {title, "plans/1"}, [](int, int) { return true; });
  EXPECT_TRUE(files.ok()) << files.status();
  if (!files.ok()) return "";
  for (const PlanFile& file : *files) {
    if (file.file_name != "assembly-guide.html") continue;
    testing::KeepToLookAt(absl::StrCat("guide-", design.parts.size(), ".html"), file.bytes);
    return file.bytes;
  }
  ADD_FAILURE() << "there is no guide";
  return "";
}

Json Open(const std::string& page, const std::vector<std::string>& flags = {}) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "guide.html";
  EXPECT_TRUE(WriteFile(file, page).ok());
  return testing::OpenPageAt(file, "#test", flags);
}

// Each step was reached by a key, and drawn with all that it has.
void ExpectStepsShown(const Json& told, std::size_t steps) {
  ASSERT_EQ(told["answers"].size(), steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const Json& answer = told["answers"][i];
    EXPECT_EQ(answer["reached"], absl::StrCat("#step-", i + 1));
    EXPECT_THAT(answer["shown"].get<std::string>(), StartsWith(absl::StrCat("Step ", i + 1)));
    ASSERT_TRUE(answer["view"].is_object());
    EXPECT_EQ(answer["moved"], true);
    EXPECT_GT(answer["view"]["colours"].get<int>(), 50);
    EXPECT_GT(answer["coloursTogether"].get<int>(), 50);
  }
  EXPECT_EQ(told["isPicture"], true) << "Escape goes back to the picture";
  EXPECT_EQ(told["last"], steps > 1 ? absl::StrCat("#step-", steps - 1) : "");
}

TEST(GuidePageTest, TurnsStepsOfAPeggedTable) {
  const Json told = Open(GuideOf(ExampleTable(), ExampleItems(), "Table <script>&\"'"));
  ExpectStepsShown(told, 3);
  const Json& first = told["answers"][0]["view"];
  EXPECT_EQ(first["standing"], 0);
  EXPECT_EQ(first["added"], 6);
  EXPECT_EQ(first["fasteners"], 8);
  EXPECT_EQ(first["goals"], 8);
  EXPECT_EQ(first["arrows"], 4);
  const Json& last = told["answers"][2]["view"];
  EXPECT_EQ(last["standing"], 8);
  EXPECT_EQ(last["added"], 1);
  EXPECT_EQ(last["fasteners"], 6);
}

TEST(GuidePageTest, TurnsStepsThatScrewsHold) {
  const Json told = Open(GuideOf(ExampleRack(), ExampleItems(), "Rack"));
  int fasteners = 0;
  for (const Json& answer : told["answers"]) fasteners += answer["view"]["fasteners"].get<int>();
  EXPECT_EQ(fasteners, 4);
  ExpectStepsShown(told, told["answers"].size());
}

TEST(GuidePageTest, AWallOfManyPegsIsOneSmallPage) {
  const std::string page = GuideOf(ExampleWall(), WallItems(), "Wall");
  EXPECT_LT(page.size(), 2u << 20);
  const Json told = Open(page);
  ExpectStepsShown(told, told["answers"].size());
  int pegs = 0;
  for (const Json& answer : told["answers"]) {
    pegs += answer["view"]["fasteners"].get<int>();
    EXPECT_LE(answer["view"]["draws"].get<int>(), 12) << "what is alike is drawn at once";
  }
  EXPECT_EQ(pegs, 1333);
}

TEST(GuidePageTest, WithoutWebGlItSaysSoAndKeepsThePictures) {
  const Json told = Open(GuideOf(ExampleTable(), ExampleItems(), "Table"), {"--disable-3d-apis"});
  EXPECT_EQ(told["saysNoWebgl"], true);
  ASSERT_EQ(told["answers"].size(), 3u);
  for (const Json& answer : told["answers"]) EXPECT_TRUE(answer["view"].is_null());
}

}  // namespace
}  // namespace mortise::fabplanner
