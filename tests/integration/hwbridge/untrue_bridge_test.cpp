// The bridge as a process at a machine that does not keep its word: what is wrong is named to the
// fabplanner and in the log, and nothing is called cut.
#include "hwbridge/registers/registers.h"
#include "tests/integration/hwbridge/bridge_fixture.h"
#include "tests/integration/hwbridge/fixed_machine.h"

namespace mortise::hwbridge {
namespace {

// The saw's place is taken by a machine that is sound but for one thing.
class BridgeOfAnUntrueMachine : public BridgeProcess {
 protected:
  void StartWith(const MachineStatus& status, std::uint16_t version = kRegisterMapVersion) {
    StatusRegisters registers = EncodeStatus(status);
    registers[0] = version;
    machine_ = std::make_unique<FixedMachine>(std::stoi(machine_port_.port()), registers);
    StartBridge({"--machine", absl::StrCat("other=chop-saw@", machine_port_.address(), "/1")});
    v1::CutCommand command = Crosscut(1);
    command.set_machine("other");
    planner_.Give(command);
  }

  static MachineStatus Sound() {
    MachineStatus status;
    status.identity = 7;
    status.boot_epoch = 1;
    status.state = PackMlState::kExecute;
    status.heartbeat_timeout = 2.0;
    return status;
  }

  // Told to the fabplanner as the reason, in the log, and nothing was reported.
  void ExpectAlarm(const std::string& because) {
    ASSERT_TRUE(planner_.Await([&](const Planner& planner) {
      const auto held = planner.held.find("other");
      return held != planner.held.end() && held->second.find(because) != std::string::npos;
    })) << because;
    EXPECT_TRUE(bridge_->AwaitOutput(because));
    EXPECT_TRUE(planner_.Await([](const Planner& planner) { return planner.reports.empty(); }));
  }

  const testing::ReservedPort machine_port_;
  std::unique_ptr<FixedMachine> machine_;
};

TEST_F(BridgeOfAnUntrueMachine, AnotherMapIsNamed) {
  StartWith(Sound(), 2);
  ExpectAlarm("status[0]: register map 2, not 1");
  EXPECT_EQ(machine_->numbers(), 0);
}

TEST_F(BridgeOfAnUntrueMachine, AnotherKindIsNamed) {
  MachineStatus status = Sound();
  status.kind = MachineKind::kJigsaw;
  StartWith(status);
  ExpectAlarm("the machine says that it is a jigsaw, but a chop-saw is expected");
  EXPECT_EQ(machine_->numbers(), 0);
}

TEST_F(BridgeOfAnUntrueMachine, AStaleDoneIsNoCut) {
  MachineStatus status = Sound();
  status.done = 1;
  status.result = JobResult::kDone;
  StartWith(status);
  ExpectAlarm("number 1 is done, but has accepted none above 0");
  EXPECT_EQ(machine_->numbers(), 0);
}

// The alarm is in the journal: a restart clears it as little as resuming an order of other
// machines.
TEST_F(BridgeOfAnUntrueMachine, TheAlarmStandsUntilItIsClearedByName) {
  MachineStatus status = Sound();
  status.done = 1;
  status.result = JobResult::kDone;
  StartWith(status);
  ExpectAlarm("number 1 is done, but has accepted none above 0");
  machine_.reset();
  machine_ = std::make_unique<FixedMachine>(std::stoi(machine_port_.port()), EncodeStatus(Sound()));
  bridge_.reset();
  StartBridge({"--machine", absl::StrCat("other=chop-saw@", machine_port_.address(), "/1")});
  ASSERT_TRUE(planner_.Await([](const Planner& planner) {
    return planner.hellos.size() == 2u && planner.alarms.at("other") &&
           planner.states.at("other") == "HELD";
  }));
  EXPECT_EQ(machine_->numbers(), 0);
  planner_.ClearAlarm("other");
  EXPECT_TRUE(planner_.Await([](const Planner& planner) { return !planner.alarms.at("other"); }));
  planner_.Resume();  // the order that the alarm had held
  EXPECT_TRUE(planner_.Await([this](const Planner&) { return machine_->numbers() > 0; }));
}

TEST_F(BridgeOfAnUntrueMachine, ANumberThatIsNeverAcceptedEndsInTheAlarm) {
  StartWith(Sound());
  ExpectAlarm("the machine was given number 1 5 times and never accepted it");
  EXPECT_EQ(machine_->numbers(), 5);
}

}  // namespace
}  // namespace mortise::hwbridge
