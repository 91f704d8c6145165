// A worker at a machine that does not keep its word: nothing is cut twice or called cut untruly,
// nothing is repeated for ever, and what is wrong is named.
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

class UntrueMachineTest : public testing::Test {
 protected:
  UntrueMachineTest() : machine_(clock_) { StartBridge(); }

  void StartBridge(MachineKind kind = MachineKind::kChopSaw) {
    worker_.reset();
    journal_.reset();
    journal_ = *Journal::Open(folder_.path() / "journal", {.flush = false});
    MachineWorker::Options options;
    options.name = "saw";
    options.kind = kind;
    worker_ = std::make_unique<MachineWorker>(options, machine_, *journal_, clock_);
  }

  void Give(std::int64_t sequence, const std::string& work_order = "workOrders/a") {
    const Job job = CrosscutJob("leg-" + std::to_string(sequence), 0.3 * sequence, 0.3);
    ASSERT_TRUE(journal_->AddCut({{work_order, "saw", sequence}, job}).ok());
  }

  void Scan(double seconds) {
    const double end = clock_.now + seconds;
    while (clock_.now < end) {
      worker_->Cycle();
      clock_.now += kScan;
    }
  }

  // Scans until number 1 is written.
  void GiveNumberOne() {
    Give(1);
    Give(2);
    Scan(0.5);
    ASSERT_EQ(machine_.numbers.size(), 1u);
    ASSERT_EQ(machine_.numbers[0].number, 1u);
  }

  std::vector<CutReport> Reports() const { return journal_->UnacknowledgedReports(); }

  // The first cut ended as one that a person must look at, everything is held, and no further scan
  // changes that or writes a number.
  void ExpectUnknownAndHeld(const std::string& because) {
    const std::size_t numbers = machine_.numbers.size();
    Scan(20.0);
    ASSERT_EQ(Reports().size(), 1u);
    EXPECT_EQ(Reports()[0].key.sequence, 1);
    EXPECT_EQ(Reports()[0].outcome, CutOutcome::kFailed);
    EXPECT_THAT(Reports()[0].message, HasSubstr(because));
    EXPECT_THAT(Reports()[0].message, HasSubstr("look at the material"));
    EXPECT_TRUE(worker_->View().held);
    EXPECT_EQ(machine_.numbers.size(), numbers);
  }

  TemporaryFolder folder_;
  ManualClock clock_;
  ScriptedMachine machine_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<MachineWorker> worker_;
};

TEST_F(UntrueMachineTest, ANumberNeverAcceptedIsWrittenFiveTimesThenHeld) {
  Give(1);
  Scan(120.0);
  ASSERT_EQ(machine_.numbers.size(), 5u);
  for (std::size_t i = 1; i < machine_.numbers.size(); ++i) {
    EXPECT_EQ(machine_.numbers[i].number, 1u);
    EXPECT_GE(machine_.numbers[i].time - machine_.numbers[i - 1].time, 1.0);
  }
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("number 1 5 times and never accepted it"));
  EXPECT_TRUE(Reports().empty());
  // Somebody has looked, and it is tried again; and held again.
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  EXPECT_FALSE(worker_->View().held);
  Scan(120.0);
  EXPECT_EQ(machine_.numbers.size(), 10u);
  EXPECT_TRUE(worker_->View().held);
  // Then it is accepted after all, and made.
  ASSERT_TRUE(worker_->Resume("").ok());
  Scan(0.1);
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(5.0);
  machine_.Echo(1, 1, JobResult::kDone);
  Scan(1.0);
  ASSERT_EQ(Reports().size(), 1u);
  EXPECT_EQ(Reports()[0].outcome, CutOutcome::kDone);
  EXPECT_EQ(machine_.numbers.back().number, 1u);
}

TEST_F(UntrueMachineTest, ACutThatNeverEndsRaisesTheAlarm) {
  GiveNumberOne();
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(290.0);
  EXPECT_FALSE(worker_->View().held);
  Scan(20.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because,
              HasSubstr("at cut 1 of workOrders/a for 300 s and has not ended it, and is EXECUTE"));
  // A person looks and lets it go on: it has as long again, and then a person must look again.
  ASSERT_TRUE(worker_->Resume("").ok());
  Scan(290.0);
  EXPECT_FALSE(worker_->View().held);
  Scan(20.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_TRUE(Reports().empty());
  EXPECT_EQ(machine_.numbers.size(), 1u);
  // What the machine says in the end is what counts.
  machine_.Echo(1, 1, JobResult::kDone);
  Scan(1.0);
  ASSERT_EQ(Reports().size(), 1u);
  EXPECT_EQ(Reports()[0].outcome, CutOutcome::kDone);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_EQ(machine_.numbers.size(), 1u);
}

TEST_F(UntrueMachineTest, ACutThatIsHeldAtTheMachineWaitsForPeople) {
  GiveNumberOne();
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(100.0);
  machine_.registers[input::kState] = static_cast<std::uint16_t>(PackMlState::kHeld);
  Scan(10000.0);
  EXPECT_EQ(worker_->View().held_because, "the machine went to HELD (none)");
}

TEST_F(UntrueMachineTest, AMachineThatStartsForEverRaisesTheAlarm) {
  machine_.registers[input::kState] = static_cast<std::uint16_t>(PackMlState::kStarting);
  Give(1);
  Scan(310.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("has not ended it, and is STARTING"));
  EXPECT_TRUE(machine_.numbers.empty());
}

TEST(CutPatience, GrowsWithTheCutAndCanBeSet) {
  EXPECT_EQ(DefaultCutPatience(CrosscutJob("leg", 0.3, 0.3)), 300.0);
  EXPECT_NEAR(DefaultCutPatience(CrosscutJob("beam", 6.0, 6.0)), 5 * (10.0 + 60.0), 1e-9);
  EXPECT_NEAR(DefaultCutPatience(OutlineJob("seat", 0.5, 10)), 5 * (10.0 + 200.0), 1e-9);
  CutPatience patience(60.0, 1.5);
  const CutOrder order = {{"workOrders/a", "saw", 1}, CrosscutJob("leg", 0.3, 0.3)};
  EXPECT_FALSE(patience.Note(order, PackMlState::kExecute, 0.0));
  // Nobody knows what happens while nobody looks.
  EXPECT_FALSE(patience.Note(order, PackMlState::kExecute, 1000.0));
  double now = 1000.0;
  while (now < 1058.0) EXPECT_FALSE(patience.Note(order, PackMlState::kExecute, now += 1.0));
  EXPECT_TRUE(patience.Note(order, PackMlState::kExecute, now += 1.0));
}

TEST_F(UntrueMachineTest, WhatIsDoneWithoutBeingAcceptedGetsNoNumber) {
  machine_.Echo(0, 1, JobResult::kDone);
  Give(1);
  Scan(20.0);
  EXPECT_TRUE(machine_.numbers.empty());
  EXPECT_TRUE(Reports().empty());
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("number 1 is done, but has accepted none"));
  (void)worker_->Resume("");
  Scan(20.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_TRUE(machine_.numbers.empty());
}

TEST_F(UntrueMachineTest, AStaleDoneIsNotACut) {
  GiveNumberOne();
  machine_.Echo(0, 1, JobResult::kDone);
  Scan(0.1);
  machine_.Echo(1, 1, JobResult::kDone);  // too late to be believed
  ExpectUnknownAndHeld("accepted none above 0");
}

TEST_F(UntrueMachineTest, ANumberThatIsDoneBeforeItIsWrittenIsNotACut) {
  Give(1);
  const auto claim = [this](int address, std::span<const std::uint16_t>) {
    if (address == holding::kJob) machine_.Echo(1, 1, JobResult::kDone);
    return address == holding::kJob ? PeerUnavailable("saw", "timed out") : absl::OkStatus();
  };
  machine_.on_write = claim;
  Scan(0.5);
  EXPECT_TRUE(machine_.numbers.empty());
  ExpectUnknownAndHeld("before it was given it");
}

TEST_F(UntrueMachineTest, NumbersThatNobodyGaveMakeTheCutUnknown) {
  GiveNumberOne();
  machine_.Echo(9, 1, JobResult::kDone);
  ExpectUnknownAndHeld("has taken number 9, the journal gave only 1");
}

TEST_F(UntrueMachineTest, ADoneThatIsHugeMakesTheCutUnknown) {
  GiveNumberOne();
  machine_.registers[input::kDone - 1] = 0x7fff;
  machine_.Echo(1, 0xffff, JobResult::kDone);
  ExpectUnknownAndHeld("number 2147483647 is done");
}

TEST_F(UntrueMachineTest, ADoneWithoutAResultMakesTheCutUnknown) {
  GiveNumberOne();
  machine_.Echo(1, 1, JobResult::kNone);
  ExpectUnknownAndHeld("but not how it ended");
}

TEST_F(UntrueMachineTest, AnIdentityThatJumpsMakesTheCutUnknown) {
  GiveNumberOne();
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(0.5);
  machine_.registers[input::kIdentity] = 8;
  Scan(0.1);
  machine_.registers[input::kIdentity] = 7;
  machine_.Echo(1, 1, JobResult::kDone);
  ExpectUnknownAndHeld("identity of the machine's memory changed from 7 to 8");
}

TEST_F(UntrueMachineTest, ABootEpochThatGoesBackMakesTheCutUnknown) {
  machine_.registers[input::kBootEpoch] = 9;
  GiveNumberOne();
  machine_.registers[input::kBootEpoch] = 3;
  Scan(0.1);
  machine_.registers[input::kBootEpoch] = 9;
  machine_.Echo(1, 1, JobResult::kDone);
  ExpectUnknownAndHeld("boot epoch went back from 9 to 3");
}

TEST_F(UntrueMachineTest, AnAcceptanceThatIsTakenBackNeverGetsTheNumberAgain) {
  GiveNumberOne();
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(0.5);
  machine_.Echo(0, 0, JobResult::kNone);
  ExpectUnknownAndHeld("went back from 1 to 0");
}

TEST_F(UntrueMachineTest, NorDoesItAfterTheBridgeHasRestarted) {
  GiveNumberOne();
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(0.5);
  machine_.Echo(0, 0, JobResult::kNone);
  StartBridge();
  ExpectUnknownAndHeld("had accepted number 1 and now says 0");
  // The next cut, which somebody lets begin, has a number of its own.
  ASSERT_TRUE(worker_->Resume("").ok());
  Scan(1.0);
  EXPECT_EQ(machine_.numbers.back().number, 2u);
}

TEST_F(UntrueMachineTest, AnIdentityThatJumpsBetweenCutsHoldsTheNextOrder) {
  Scan(0.5);
  machine_.registers[input::kIdentity] = 8;
  Scan(0.5);
  EXPECT_TRUE(worker_->View().held);
  Give(1);
  Scan(20.0);
  EXPECT_TRUE(machine_.numbers.empty());
  EXPECT_THAT(worker_->View().held_because, HasSubstr("identity"));
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  Scan(0.5);
  EXPECT_EQ(machine_.numbers.size(), 1u);
}

TEST_F(UntrueMachineTest, ARestartThatRemembersIsNoAlarm) {
  GiveNumberOne();
  machine_.Echo(1, 0, JobResult::kNone);
  Scan(0.5);
  ++machine_.registers[input::kBootEpoch];
  machine_.Echo(1, 1, JobResult::kDone);  // the sensor behind the blade says so
  Scan(0.5);
  ASSERT_EQ(Reports().size(), 1u);
  EXPECT_EQ(Reports()[0].outcome, CutOutcome::kDone);
  EXPECT_EQ(worker_->View().held_because, "the machine restarted");
}

struct Nonsense {
  const char* name;
  int at;
  std::uint16_t value;
  const char* because;
};

class NonsenseTest : public UntrueMachineTest, public testing::WithParamInterface<Nonsense> {};

TEST_P(NonsenseTest, HoldsBeforeTheFirstNumberAndIsNamed) {
  machine_.registers[GetParam().at] = GetParam().value;
  Give(1);
  Scan(0.1);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr(GetParam().because));
  const absl::Status resumed = worker_->Resume("");
  EXPECT_EQ(resumed.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(resumed.message()), HasSubstr(GetParam().because));
  Scan(60.0);
  EXPECT_TRUE(machine_.numbers.empty());
  EXPECT_EQ(machine_.writes[holding::kCommand], 0);
  EXPECT_TRUE(Reports().empty());
}

TEST_P(NonsenseTest, InACutHoldsItAndSaysNothingOfIt) {
  GiveNumberOne();
  const StatusRegisters sound = machine_.registers;
  machine_.Echo(1, 1, JobResult::kDone);
  machine_.registers[GetParam().at] = GetParam().value;
  Scan(20.0);
  EXPECT_TRUE(Reports().empty());
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr(GetParam().because));
  EXPECT_EQ(machine_.numbers.size(), 1u);
  // Sense alone resumes nothing.
  machine_.registers = sound;
  Scan(20.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr(GetParam().because));
  EXPECT_EQ(machine_.numbers.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(
    Registers, NonsenseTest,
    testing::Values(Nonsense{"Version", input::kVersion, 2, "register map 2, not 1"},
                    Nonsense{"NoVersion", input::kVersion, 0, "register map 0, not 1"},
                    Nonsense{"Kind", input::kKind, 3, "unknown kind of machine 3"},
                    Nonsense{"OtherKind", input::kKind, 2,
                             "says that it is a jigsaw, but a chop-saw is expected"},
                    Nonsense{"State", input::kState, 99, "unknown PackML state 99"},
                    Nonsense{"EmergencyStop", input::kEmergencyStop, 7, "emergency stop is 7"},
                    Nonsense{"HoldReason", input::kHoldReason, 9, "unknown hold reason 9"},
                    Nonsense{"Result", input::kResult, 99, "unknown result 99"},
                    Nonsense{"Progress", input::kProgress, 60000, "progress is 60000 of 1000"},
                    Nonsense{"Timeout", input::kHeartbeatTimeout, 0, "heartbeat timeout is 0"}),
    [](const auto& one) { return one.param.name; });

TEST_F(UntrueMachineTest, AHeartThatStandsGetsNoNumberAndRaisesTheAlarm) {
  machine_.heart_beats = false;
  Give(1);
  Scan(1.4);
  EXPECT_FALSE(worker_->View().held);
  Scan(0.3);  // past line_lost_after
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("heartbeat stands still"));
  EXPECT_FALSE(worker_->Resume("").ok());
  machine_.heart_beats = true;
  Scan(20.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_TRUE(machine_.numbers.empty());
  ASSERT_TRUE(worker_->Resume("").ok());
  Scan(0.5);
  EXPECT_EQ(machine_.numbers.size(), 1u);
}

TEST_F(UntrueMachineTest, AnAlarmHoldsOrdersThatComeLater) {
  machine_.Echo(0, 1, JobResult::kDone);
  Give(1);
  Scan(1.0);
  machine_.Echo(0, 0, JobResult::kNone);
  Give(1, "workOrders/b");
  Scan(20.0);
  EXPECT_TRUE(machine_.numbers.empty());
  ASSERT_TRUE(worker_->Resume("workOrders/b").ok());
  Scan(1.0);
  EXPECT_EQ(machine_.numbers.size(), 1u);
}

TEST_F(UntrueMachineTest, CommandsThatDoNothingComeToAnEnd) {
  machine_.registers[input::kState] = static_cast<std::uint16_t>(PackMlState::kStopped);
  Give(1);
  Scan(120.0);
  EXPECT_EQ(machine_.writes[holding::kCommand], 10);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("10 commands in vain, and is STOPPED"));
}

// It does what it is told and falls back each time.
TEST_F(UntrueMachineTest, CommandsInACircleComeToAnEnd) {
  const auto set = [this](PackMlState state) {
    machine_.registers[input::kState] = static_cast<std::uint16_t>(state);
  };
  set(PackMlState::kStopped);
  machine_.on_write = [&](int address, std::span<const std::uint16_t> values) {
    if (address != holding::kCommand) return absl::OkStatus();
    set(values[0] == static_cast<int>(PackMlCommand::kReset) ? PackMlState::kIdle
                                                             : PackMlState::kStopped);
    return absl::OkStatus();
  };
  Give(1);
  Scan(120.0);
  EXPECT_EQ(machine_.writes[holding::kCommand], 10);
  EXPECT_TRUE(worker_->View().held);
}

TEST_F(UntrueMachineTest, AnIdleMachineThatWillNotStopRaisesTheAlarm) {
  Scan(120.0);
  EXPECT_EQ(machine_.writes[holding::kCommand], 10);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("10 commands in vain, and is EXECUTE"));
}

TEST_F(UntrueMachineTest, RefusalsWithoutEndComeToAnEnd) {
  machine_.on_write = [this](int address, std::span<const std::uint16_t> values) {
    if (address == holding::kSequenceNumber) {
      machine_.Echo(values[1], values[1], JobResult::kWrongState);
    }
    return absl::OkStatus();
  };
  Give(1);
  Scan(120.0);
  EXPECT_EQ(machine_.numbers.size(), 10u);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because,
              HasSubstr("10 numbers without cutting, the last as wrong-state"));
  EXPECT_TRUE(Reports().empty());
}

TEST_F(UntrueMachineTest, ParametersThatNeverGetThroughComeToAnEnd) {
  machine_.on_write = [](int address, std::span<const std::uint16_t>) {
    return address == holding::kJob ? PeerUnavailable("saw", "timed out") : absl::OkStatus();
  };
  Give(1);
  Scan(120.0);
  EXPECT_EQ(machine_.writes[holding::kJob], 10);
  EXPECT_TRUE(machine_.numbers.empty());
  EXPECT_TRUE(worker_->View().held);
  EXPECT_THAT(worker_->View().held_because, HasSubstr("did not reach the machine in 10 tries"));
}

TEST_F(UntrueMachineTest, ALostLineSaysHow) {
  Give(1);
  Scan(0.1);
  machine_.read_answer = PeerUnavailable("10.0.0.7:502 unit 1", "Connection refused");
  Scan(5.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_EQ(worker_->View().state, "UNDEFINED");
  EXPECT_EQ(worker_->View().held_because,
            "the line to the machine is lost: 10.0.0.7:502 unit 1: Connection refused");
  EXPECT_THAT(std::string(worker_->Resume("").message()), HasSubstr("Connection refused"));
}

TEST_F(UntrueMachineTest, AMachineThatRefusesToBeReadIsNotALostLine) {
  machine_.read_answer =
      PreconditionFailed("MACHINE_REFUSED", "10.0.0.7:502 unit 1: Illegal function");
  Give(1);
  Scan(5.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_EQ(worker_->View().held_because,
            "the machine refuses to be read: 10.0.0.7:502 unit 1: Illegal function");
}

}  // namespace
}  // namespace mortise::hwbridge
