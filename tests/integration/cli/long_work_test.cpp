// Commands that wait, as a person at a terminal meets them: what they say at once, what Ctrl-C and
// SIGTERM do, and `mortise operations`; against a gateway that this test plays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/integration/cli/played_house.h"

namespace mortise::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(LongWorkTest, CtrlCCancelsWhatTheCommandStartedAndSaysWhatIsKept) {
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  EXPECT_TRUE(house_.cancelled().empty());
  EXPECT_EQ(plan->End(SIGINT), 130);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{kPlanning});
  EXPECT_THAT(plan->Output(), HasSubstr(absl::StrCat(kPlanning,
                                                     " was cancelled; its best so far "
                                                     "is kept in fronts/best")));
}

TEST_F(LongWorkTest, SigtermDoesTheSame) {
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  EXPECT_EQ(plan->End(SIGTERM), 143);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{kPlanning});
}

TEST_F(LongWorkTest, ASecondCtrlCLeavesAtOnceAndSaysHowToGoOn) {
  house_.SetStops(false);
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  plan->Signal(SIGINT);
  ASSERT_TRUE(plan->AwaitOutput("Ctrl-C again leaves at once")) << plan->Output();
  EXPECT_EQ(plan->End(SIGINT), 130);
  EXPECT_THAT(plan->Output(),
              AllOf(HasSubstr(absl::StrCat(Command(), " operations watch ", kPlanning)),
                    HasSubstr(absl::StrCat(Command(), " operations cancel ", kPlanning))));
}

// What is asked for is begun by the time somebody could cancel it, and must not be left behind.

TEST_F(LongWorkTest, CtrlCWhileTheOperationIsBeingStartedCancelsItToo) {
  house_.SetAnswers(false);
  const auto plan = Start({"plan", "table"});
  house_.AwaitPlanning();
  plan->Signal(SIGINT);
  EXPECT_TRUE(plan->AwaitOutput("cancelling once it has started")) << plan->Output();
  house_.SetAnswers(true);
  EXPECT_EQ(plan->Wait(), 130);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{kPlanning});
}

TEST_F(LongWorkTest, JsonStaysOneDocument) {
  const auto plan = StartJson("plan table");
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  EXPECT_EQ(plan->End(SIGINT), 130);
  const Json error = Document()["error"];
  EXPECT_EQ(error["code"], "CANCELLED");
  EXPECT_EQ(error["reason"], "INTERRUPTED");
  EXPECT_EQ(error["field"], kPlanning);
}

TEST_F(LongWorkTest, JsonStaysOneDocumentWhereACommandLeavesAtOnce) {
  house_.SetStops(false);
  const auto plan = StartJson("plan table");
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  plan->Signal(SIGINT);
  ASSERT_TRUE(plan->AwaitOutput("Ctrl-C again leaves at once")) << plan->Output();
  EXPECT_EQ(plan->End(SIGTERM), 143);
  EXPECT_EQ(Document()["error"]["reason"], "INTERRUPTED");
}

TEST_F(LongWorkTest, AnUndisturbedCommandPrintsItsResult) {
  const auto plan = StartJson("plan table");
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(plan->Wait(), 0);
  EXPECT_EQ(Document()["name"], "plans/p1");
  EXPECT_TRUE(house_.cancelled().empty());
}

TEST_F(LongWorkTest, MachinesGoOnWhenACommandIsLeft) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto release = Start({"fab", "release", "plans/p1"});
    ASSERT_TRUE(release->AwaitOutput("Ctrl-C leaves it running")) << release->Output();
    EXPECT_EQ(release->End(signal), 128 + signal);
    EXPECT_THAT(
        release->Output(),
        AllOf(HasSubstr("workOrders/o1 goes on"), HasSubstr(Command() + " fab hold workOrders/o1"),
              HasSubstr(Command() + " fab watch workOrders/o1"),
              HasSubstr(absl::StrCat(Command(), " operations cancel ", kCutting))));
  }
  EXPECT_TRUE(house_.cancelled().empty());
}

TEST_F(LongWorkTest, DetachedWorkIsStartedAndLeft) {
  const auto plan = Start({"plan", "table", "--detach"});
  EXPECT_EQ(plan->Wait(), 0);
  EXPECT_THAT(plan->Output(), HasSubstr(absl::StrCat("operations watch ", kPlanning)));
  const auto release = StartJson("fab release plans/p1 --detach");
  EXPECT_EQ(release->Wait(), 0);
  EXPECT_EQ(Document()["name"], kCutting);
  EXPECT_TRUE(house_.cancelled().empty());
  const auto with_files = Start({"plan", "table", "--detach", "--out", "x"});
  EXPECT_EQ(with_files->Wait(), 2);
}

TEST_F(LongWorkTest, WatchingEndsWithoutCancelling) {
  house_.Add(kPlanning);
  const auto watch = Start({"operations", "watch", "fabplanner/p1"});
  ASSERT_TRUE(watch->AwaitOutput("laying out boards")) << watch->Output();
  EXPECT_EQ(watch->End(SIGINT), 130);
  EXPECT_THAT(watch->Output(), HasSubstr(absl::StrCat(kPlanning, " goes on")));
  EXPECT_TRUE(house_.cancelled().empty());
  const auto to_the_end = StartJson(absl::StrCat("operations watch ", kPlanning));
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(to_the_end->Wait(), 0);
  EXPECT_EQ(Document()["result"]["name"], "plans/p1");
  const auto unknown = Start({"operations", "watch", "operations/fabplanner/none"});
  EXPECT_EQ(unknown->Wait(), 1);
}

TEST_F(LongWorkTest, WhatWaitsForOtherWorkSaysSo) {
  house_.AddPending(kPlanning);
  const auto watch = Start({"operations", "watch", kPlanning});
  ASSERT_TRUE(watch->AwaitOutput("operations list --active")) << watch->Output();
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(watch->Wait(), 0);
}

TEST_F(LongWorkTest, ListsWhatRunsFromAllPages) {
  house_.Add("operations/fabplanner/a");
  house_.Add("operations/pareto/b");
  const auto list = Start({"operations", "list", "--active", "--subject", "templates/table"});
  EXPECT_EQ(list->Wait(), 0);
  EXPECT_THAT(list->Output(),
              AllOf(HasSubstr("operations/fabplanner/a"), HasSubstr("operations/pareto/b"),
                    HasSubstr("running"), HasSubstr("CreatePlan"), HasSubstr("templates/table"),
                    HasSubstr("3/10  laying out boards")));
  ASSERT_EQ(house_.listed().size(), 2u);
  const v1::ListOperationsRequest asked = house_.listed().front();
  EXPECT_EQ(asked.states_size(), 2);
  EXPECT_EQ(asked.subject(), "templates/table");
  EXPECT_TRUE(asked.omit_results());
  const auto first = StartJson("operations list --limit 1");
  EXPECT_EQ(first->Wait(), 0);
  EXPECT_EQ(Document().size(), 1u);
}

TEST_F(LongWorkTest, ShowsOne) {
  house_.Add(kPlanning);
  const auto show = Start({"operations", "show", kPlanning});
  EXPECT_EQ(show->Wait(), 0);
  EXPECT_THAT(show->Output(), AllOf(HasSubstr("running"), HasSubstr("FabPlannerService/CreatePlan"),
                                    HasSubstr("users/ada")));
}

TEST_F(LongWorkTest, CancelsSeveralAndSaysWhatIsKept) {
  house_.Add("operations/fabplanner/a");
  house_.Add("operations/pareto/b");
  const auto cancel = Start({"operations", "cancel", "fabplanner/a", "operations/pareto/b"});
  EXPECT_EQ(cancel->Wait(), 0);
  EXPECT_EQ(house_.cancelled(),
            (std::vector<std::string>{"operations/fabplanner/a", "operations/pareto/b"}));
  EXPECT_THAT(cancel->Output(), HasSubstr("operations/pareto/b: cancelled, fronts/best is kept"));
}

}  // namespace
}  // namespace mortise::cli
