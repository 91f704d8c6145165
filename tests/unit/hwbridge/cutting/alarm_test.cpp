// The alarm of a machine: who clears it, and that nothing else does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "hwbridge/cutting/machine_worker.h"
#include "tests/unit/hwbridge/cutting/scripted_machine.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

using ::testing::HasSubstr;

constexpr double kScan = 0.05;  // s

class AlarmTest : public testing::Test {
 protected:
  AlarmTest() : machine_(clock_) { StartBridge(); }

  void StartBridge() {
    worker_.reset();
    journal_.reset();
    journal_ = *Journal::Open(folder_.path() / "journal", {.flush = false});
    MachineWorker::Options options;
    options.name = "saw";
    worker_ = std::make_unique<MachineWorker>(options, machine_, *journal_, clock_);
  }

  void Give(const std::string& work_order, std::int64_t sequence = 1) {
    ASSERT_TRUE(
        journal_->AddCut({{work_order, "saw", sequence}, CrosscutJob("leg", 0.3, 0.3)}).ok());
  }

  void Scan(double seconds) {
    const double end = clock_.now + seconds;
    while (clock_.now < end) {
      worker_->Cycle();
      clock_.now += kScan;
    }
  }

  // Gives `work_order` a cut that the machine makes under `number`.
  void Make(const std::string& work_order, std::uint16_t number) {
    Give(work_order);
    Scan(0.5);
    ASSERT_EQ(machine_.numbers.back().number, number);
    machine_.Echo(number, number, JobResult::kDone);
    Scan(0.5);
    ASSERT_EQ(Reports().back().outcome, CutOutcome::kDone);
  }

  void JumpOfIdentity() {
    Scan(0.5);
    machine_.registers[input::kIdentity] = 9;
    Scan(0.5);
    ASSERT_TRUE(worker_->View().alarm);
  }

  // Whatever order comes, none of its cuts gets a number.
  void ExpectAlarm(const std::string& because) {
    const std::size_t numbers = machine_.numbers.size();
    EXPECT_TRUE(worker_->View().alarm);
    EXPECT_TRUE(worker_->View().held);
    EXPECT_THAT(worker_->View().held_because, HasSubstr(because));
    Give("workOrders/later-" + std::to_string(++later_));
    Scan(20.0);
    EXPECT_EQ(machine_.numbers.size(), numbers);
    EXPECT_THAT(worker_->View().held_because, HasSubstr(because));
  }

  void ExpectNoAlarm() {
    EXPECT_FALSE(worker_->View().alarm);
    const std::size_t numbers = machine_.numbers.size();
    Give("workOrders/later-" + std::to_string(++later_));
    Scan(0.5);
    EXPECT_EQ(machine_.numbers.size(), numbers + 1);
  }

  std::vector<CutReport> Reports() const { return journal_->UnacknowledgedReports(); }

  TemporaryFolder folder_;
  ManualClock clock_;
  ScriptedMachine machine_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<MachineWorker> worker_;
  int later_ = 0;
};

TEST_F(AlarmTest, IsNotClearedByResumingAnOrderThatItDoesNotHold) {
  JumpOfIdentity();
  Give("workOrders/b");
  Scan(1.0);
  const absl::Status resumed = worker_->Resume("workOrders/unrelated");
  EXPECT_EQ(resumed.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(resumed).reason, "ALARM");
  EXPECT_THAT(std::string(resumed.message()), HasSubstr("changed from 7 to 9"));
  Scan(1.0);
  ExpectAlarm("changed from 7 to 9");
}

// Held by an operator, at all machines; this one has no cut of it.
TEST_F(AlarmTest, IsNotClearedByResumingAnOrderThatAPersonHeld) {
  JumpOfIdentity();
  worker_->Hold("workOrders/a", "an operator said so");
  EXPECT_EQ(DetailOf(worker_->Resume("workOrders/a")).reason, "ALARM");
  ExpectAlarm("changed from 7 to 9");
}

TEST_F(AlarmTest, IsClearedByResumingAnOrderThatItHoldsWhichAloneGoesOn) {
  JumpOfIdentity();
  Give("workOrders/a");
  Give("workOrders/b");
  Scan(1.0);
  ASSERT_TRUE(worker_->Resume("workOrders/b").ok());
  Scan(0.5);
  ASSERT_EQ(machine_.numbers.size(), 1u);
  EXPECT_FALSE(journal_->Intents({"workOrders/b", "saw", 1}).empty());
  machine_.Echo(1, 1, JobResult::kDone);
  Scan(20.0);
  EXPECT_EQ(machine_.numbers.size(), 1u);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_FALSE(worker_->View().alarm);
}

TEST_F(AlarmTest, OfAMachineWithoutOrdersIsClearedByItself) {
  JumpOfIdentity();
  ASSERT_TRUE(worker_->ClearAlarm().ok());
  EXPECT_FALSE(worker_->View().held);
  ExpectNoAlarm();
}

TEST_F(AlarmTest, IsClearedByItselfAndOrdersStayHeldUntilTheyAreResumed) {
  JumpOfIdentity();
  Give("workOrders/a");
  Scan(1.0);
  ASSERT_TRUE(worker_->ClearAlarm().ok());
  Scan(20.0);
  EXPECT_TRUE(machine_.numbers.empty());
  EXPECT_TRUE(worker_->View().held);
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  Scan(0.5);
  EXPECT_EQ(machine_.numbers.size(), 1u);
}

TEST_F(AlarmTest, StandsWhileTheMachineCannotBeSeen) {
  JumpOfIdentity();
  machine_.registers[input::kEmergencyStop] = 1;
  Scan(0.5);
  EXPECT_EQ(DetailOf(worker_->ClearAlarm()).reason, "LINE_LOST");
  machine_.registers[input::kEmergencyStop] = 0;
  machine_.read_answer = PeerUnavailable("saw", "timed out");
  Scan(5.0);
  EXPECT_EQ(DetailOf(worker_->ClearAlarm()).reason, "LINE_LOST");
  EXPECT_EQ(DetailOf(worker_->Resume("")).reason, "LINE_LOST");
  machine_.read_answer = absl::OkStatus();
  Scan(0.5);
  ExpectAlarm("changed from 7 to 9");
}

TEST_F(AlarmTest, OutlivesTheBridge) {
  Make("workOrders/a", 1);
  machine_.Echo(0, 0, JobResult::kNone);
  Scan(1.0);
  ASSERT_TRUE(worker_->View().alarm);
  StartBridge();
  EXPECT_TRUE(worker_->View().alarm);  // before the machine has answered, too
  Scan(1.0);
  ExpectAlarm("went back from 1 to 0");
  StartBridge();
  ExpectAlarm("went back from 1 to 0");
}

// Nonsense leaves no trace in the echo.
TEST_F(AlarmTest, OutlivesTheBridgeWhenTheMachineMakesSenseAgain) {
  machine_.registers[input::kState] = 99;
  Scan(1.0);
  machine_.registers[input::kState] = static_cast<std::uint16_t>(PackMlState::kExecute);
  StartBridge();
  Scan(1.0);
  ExpectAlarm("unknown PackML state 99");
}

TEST_F(AlarmTest, ThatIsClearedStaysSoAfterARestart) {
  Make("workOrders/a", 1);
  machine_.registers[input::kIdentity] = 9;
  machine_.Echo(0, 0, JobResult::kNone);
  Scan(1.0);
  ASSERT_TRUE(worker_->ClearAlarm().ok());
  StartBridge();
  Scan(1.0);
  ExpectNoAlarm();
  machine_.Echo(2, 2, JobResult::kDone);
  Scan(1.0);
  StartBridge();
  Scan(1.0);
  ExpectNoAlarm();
}

// While the bridge was away the machine became another one, or forgot.
struct Change {
  const char* name;
  int at;
  std::uint16_t value;
  const char* because;
};

class AlarmAtTheStart : public AlarmTest, public testing::WithParamInterface<Change> {};

TEST_P(AlarmAtTheStart, RisesThoughNobodySawTheChange) {
  machine_.registers[input::kBootEpoch] = 5;
  Make("workOrders/a", 1);
  Make("workOrders/b", 2);
  machine_.registers[GetParam().at] = GetParam().value;
  if (GetParam().at == input::kAccepted) machine_.registers[input::kDone] = GetParam().value;
  StartBridge();
  Scan(1.0);
  ExpectAlarm(GetParam().because);
}

INSTANTIATE_TEST_SUITE_P(
    Echoes, AlarmAtTheStart,
    testing::Values(Change{"Identity", input::kIdentity, 9, "memory was 7 and now is 9"},
                    Change{"BootEpoch", input::kBootEpoch, 4, "was already 5 and now is 4"},
                    Change{"Accepted", input::kAccepted, 1, "accepted number 2 and now says 1"},
                    Change{"Done", input::kDone, 1, "done number 2 and now says 1"},
                    Change{"Result", input::kResult, 6, "number 2 had ended as done and now as"}),
    [](const auto& one) { return one.param.name; });

TEST_F(AlarmTest, DoesNotRiseWhenAMachineThatRemembersRestartsWithTheBridge) {
  Make("workOrders/a", 1);
  Give("workOrders/b");
  Scan(0.5);
  machine_.registers[input::kBootEpoch] = 2;
  machine_.Echo(2, 1, JobResult::kDone);
  StartBridge();
  Scan(1.0);
  EXPECT_FALSE(worker_->View().alarm);
  EXPECT_EQ(worker_->View().held_because, "the bridge restarted");
}

// It kept its word between two echoes, but nobody had given it the number.
TEST_F(AlarmTest, RisesWhereANumberIsTakenThatWasNotGiven) {
  Give("workOrders/a");
  machine_.on_write = [this](int address, std::span<const std::uint16_t>) {
    if (address == holding::kJob) machine_.Echo(1, 1, JobResult::kDone);
    return address == holding::kJob ? PeerUnavailable("saw", "timed out") : absl::OkStatus();
  };
  Scan(1.0);
  machine_.on_write = nullptr;
  ASSERT_EQ(Reports().size(), 1u);
  EXPECT_EQ(Reports()[0].outcome, CutOutcome::kFailed);
  ExpectAlarm("before it was given it");
}

}  // namespace
}  // namespace mortise::hwbridge
