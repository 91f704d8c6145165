// The bridge as a process between a fabplanner (played by this test) and the virtual cell: cuts are
// taken over, made once and reported, whoever dies.
#include <fstream>
#include <limits>

#include "tests/integration/hwbridge/bridge_fixture.h"

namespace mortise::hwbridge {
namespace {

TEST_F(BridgeProcess, AnnouncesItsMachinesTakesCutsOverAndReportsThem) {
  std::ofstream(folder_.path() / "token") << "secret\n";
  StartBridge({"--token-file", (folder_.path() / "token").string(), "--ready-file",
               (folder_.path() / "ready").string()});
  ASSERT_TRUE(planner_.Await([](const Planner& planner) { return !planner.hellos.empty(); }));
  ASSERT_TRUE(planner_.Await([](const Planner& planner) {
    const auto& hello = planner.hellos.front();
    EXPECT_EQ(hello.bridge(), "plant");
    EXPECT_EQ(hello.next_report_number(), 1);
    EXPECT_EQ(hello.machines_size(), 2);
    EXPECT_EQ(hello.machines(0).name(), "saw");
    EXPECT_EQ(hello.machines(0).kind(), v1::CHOP_SAW_WITH_FEEDER);
    EXPECT_EQ(hello.machines(0).state(), "STOPPED");
    EXPECT_EQ(hello.machines(1).kind(), v1::JIGSAW_ROBOT);
    EXPECT_EQ(planner.authorization, "Bearer secret");
    return true;
  }));
  GiveAll();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) {
    return planner.states.at("saw") == "EXECUTE" && planner.states.at("robot") == "EXECUTE";
  }));
  ASSERT_TRUE(planner_.Await(AllReported));
  ExpectEachCutOnce();
  EXPECT_EQ(planner_.accepted.size(), static_cast<std::size_t>(kCrosscuts + kOutlines));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "ready"));
  EXPECT_EQ(bridge_->End(SIGTERM), 0);
}

TEST_F(BridgeProcess, CutsGivenTwiceAreMadeOnce) {
  StartBridge();
  GiveAll();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) { return planner.reports.size() >= 2; }));
  GiveAll();
  ASSERT_TRUE(planner_.Await(AllReported));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, ReportsAreRepeatedUntilTheyAreStored) {
  planner_.acknowledge = false;
  StartBridge();
  GiveAll();
  ASSERT_TRUE(planner_.Await(AllReported));
  StopPlanner();
  StartPlanner();
  ASSERT_TRUE(planner_.Await(
      [](const Planner& planner) { return planner.repeated_reports == kCrosscuts + kOutlines; }));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, AShortOutageOfThePlannerStopsNothing) {
  StartBridge();
  GiveAll();
  ASSERT_TRUE(planner_.Await(
      [](const Planner& planner) { return planner.accepted.size() == kCrosscuts + kOutlines; }));
  StopPlanner();
  StartPlanner();
  ASSERT_TRUE(planner_.Await(AllReported));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, WithoutThePlannerForLongCutsAreHeldUntilResumed) {
  StartBridge({"--line-lost-after", "0"});
  GiveAll();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) { return planner.reports.size() >= 1; }));
  StopPlanner();
  planner_.states.clear();
  StartPlanner();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) {
    return planner.states.contains("saw") && planner.states.at("saw") == "HELD";
  }));
  planner_.Resume();
  ASSERT_TRUE(planner_.Await(AllReported));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, HoldAndResume) {
  StartBridge();
  GiveAll();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) { return planner.reports.size() >= 1; }));
  planner_.Hold();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) {
    return planner.states.at("saw") == "HELD" && planner.states.at("robot") == "HELD";
  }));
  planner_.Resume();
  ASSERT_TRUE(planner_.Await(AllReported));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, SurvivesItsOwnDeathAgainAndAgain) {
  NoticeDeathsSoon();
  StartBridge();
  GiveAll();
  for (std::size_t reports = 1; reports <= 5; ++reports) {
    ASSERT_TRUE(planner_.Await(
        [&](const Planner& planner) { return planner.reports.size() >= reports; }, true));
    bridge_->End(SIGKILL);
    StartBridge();
    ASSERT_TRUE(planner_.Await(
        [&](const Planner& planner) { return planner.hellos.size() >= reports + 1; }));
  }
  ASSERT_TRUE(planner_.Await(AllReported, true));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, SurvivesTheDeathOfTheCell) {
  NoticeDeathsSoon();
  StartBridge();
  GiveAll();
  for (std::size_t reports = 1; reports <= 3; ++reports) {
    ASSERT_TRUE(planner_.Await(
        [&](const Planner& planner) { return planner.reports.size() >= reports; }, true));
    cell_->End(SIGKILL);
    StartCell();
  }
  ASSERT_TRUE(planner_.Await(AllReported, true));
  ExpectEachCutOnce();
}

TEST_F(BridgeProcess, ImpossibleCutsAreRejectedByName) {
  StartBridge();
  v1::CutCommand elsewhere = Crosscut(1);
  elsewhere.set_machine("nowhere");
  v1::CutCommand wrong_kind = Outline(1);
  wrong_kind.set_machine("saw");
  v1::CutCommand not_a_number = Crosscut(2);
  not_a_number.mutable_crosscut()->set_length(std::numeric_limits<double>::quiet_NaN());
  v1::CutCommand empty = Crosscut(3);
  empty.clear_cut();
  for (const auto& command : {elsewhere, wrong_kind, not_a_number, empty}) planner_.Give(command);
  ASSERT_TRUE(planner_.Await([](const Planner& planner) { return planner.reports.size() == 4; }));
  ASSERT_TRUE(planner_.Await([](const Planner& planner) {
    for (const auto& [number, report] : planner.reports) {
      EXPECT_EQ(report.outcome(), v1::CUT_REJECTED);
      EXPECT_NE(report.message(), "");
    }
    return true;
  }));
  EXPECT_TRUE(ReadCutRecord(cut_record_)->empty());
}

TEST_F(BridgeProcess, SaysWhyThePlannerRefusedTheLine) {
  planner_.refusal = {grpc::StatusCode::PERMISSION_DENIED, "a token of an operator is needed"};
  StartBridge();
  EXPECT_TRUE(bridge_->AwaitOutput("a token of an operator is needed"));
}

TEST_F(BridgeProcess, ASecondBridgeOnTheSameJournalRefuses) {
  StartBridge();
  ASSERT_TRUE(planner_.Await([](const Planner& planner) { return !planner.hellos.empty(); }));
  const auto first = std::move(bridge_);
  StartBridge();
  EXPECT_EQ(bridge_->Wait(), 1);
}

}  // namespace
}  // namespace mortise::hwbridge
