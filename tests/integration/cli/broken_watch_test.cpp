// Commands whose gateway has no stream for them, or takes their token no longer; and machines that
// no work order waits for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/integration/cli/played_house.h"

namespace mortise::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(LongWorkTest, GoesOnWithTheNewTokenOfTheFile) {
  const std::filesystem::path token = folder_.path() / "token";
  ASSERT_TRUE(WriteFile(token, "first\n").ok());
  house_.SetToken("first");
  const auto plan = Start({"--token-file", token.string(), "plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput("laying out boards")) << plan->Output();
  ASSERT_TRUE(WriteFile(token, "second\n").ok());
  house_.SetToken("second");
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(plan->Wait(), 0) << plan->Output();
}

TEST_F(LongWorkTest, AStreamThatBreaksForGoodSaysHowToGoOn) {
  house_.SetToken("another");
  const auto plan = StartJson("plan table");
  EXPECT_EQ(plan->Wait(), 1);
  const Json error = Document()["error"];
  EXPECT_EQ(error["code"], "UNAUTHENTICATED");
  EXPECT_THAT(error["message"].get<std::string>(),
              AllOf(HasSubstr("the token expired"),
                    HasSubstr(absl::StrCat(Command(), " operations watch ", kPlanning)),
                    HasSubstr(absl::StrCat(Command(), " operations cancel ", kPlanning))));
  EXPECT_TRUE(house_.cancelled().empty());
}

TEST_F(LongWorkTest, FollowsByWaitingWhereNoStreamIsToBeHad) {
  house_.SetStreams(false);
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(plan->Wait(), 0) << plan->Output();
  EXPECT_TRUE(house_.waited());
}

TEST_F(LongWorkTest, CancelsAndSeesTheEndWhereNoStreamIsToBeHad) {
  house_.SetStreams(false);
  house_.Add("operations/fabplanner/a");
  house_.Add("operations/pareto/b");
  const auto cancel = Start({"operations", "cancel", "fabplanner/a", "pareto/b"});
  EXPECT_EQ(cancel->Wait(), 0) << cancel->Output();
  EXPECT_THAT(cancel->Output(),
              AllOf(HasSubstr("fabplanner/a: cancelled"), HasSubstr("pareto/b: cancelled")));
}

TEST_F(LongWorkTest, WhatIsCancelledButNotSeenToItsEndIsNoFailure) {
  house_.SetStreams(false);
  house_.SetWaits(false);
  house_.SetStops(false);
  house_.Add("operations/fabplanner/a");
  house_.Add("operations/pareto/b");
  const auto cancel = Start({"operations", "cancel", "fabplanner/a", "pareto/b"});
  EXPECT_EQ(cancel->Wait(), 0) << cancel->Output();
  EXPECT_EQ(house_.cancelled().size(), 2u);
  EXPECT_THAT(cancel->Output(),
              HasSubstr("operations/fabplanner/a: cancelling, not seen to its end: too many"));
}

TEST_F(LongWorkTest, ANameThatIsWrongKeepsNoOtherFromBeingCancelled) {
  house_.Add("operations/pareto/b");
  const auto cancel = Start({"operations", "cancel", "fabplanner/none", "pareto/b"});
  EXPECT_EQ(cancel->Wait(), 1);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{"operations/pareto/b"});
  EXPECT_THAT(cancel->Output(), AllOf(HasSubstr("fabplanner/none: no such operation"),
                                      HasSubstr("pareto/b: cancelled")));
}

TEST_F(LongWorkTest, ShowsMachinesWithoutOrdersAndClearsTheirAlarm) {
  const auto show = Start({"fab", "show"});
  EXPECT_EQ(show->Wait(), 0) << show->Output();
  EXPECT_THAT(show->Output(),
              AllOf(HasSubstr("saw of plant raised the alarm and is HELD: it jumped"),
                    HasSubstr(Command() + " fab resume --machine saw --bridge plant"),
                    HasSubstr("robot of plant is IDLE")));
  const auto resume = Start({"fab", "resume", "--machine", "saw", "--bridge", "plant"});
  EXPECT_EQ(resume->Wait(), 0) << resume->Output();
  ASSERT_EQ(house_.resumed().size(), 1u);
  EXPECT_EQ(house_.resumed()[0].machine(), "saw");
  EXPECT_EQ(house_.resumed()[0].bridge(), "plant");
  EXPECT_EQ(house_.resumed()[0].name(), "");
  EXPECT_FALSE(house_.resumed()[0].request_id().empty());
  EXPECT_EQ(Start({"fab", "resume"})->Wait(), 2);
  EXPECT_EQ(Start({"fab", "resume", "workOrders/a", "--machine", "saw"})->Wait(), 2);
}

}  // namespace
}  // namespace mortise::cli
