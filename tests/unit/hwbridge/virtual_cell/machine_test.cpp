// The virtual machines: durations, numbers taken once, stopping safely, remembering.
#include "hwbridge/virtual_cell/machine.h"

#include <gtest/gtest.h>

#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

class MachineTest : public testing::Test {
 protected:
  std::unique_ptr<Machine> Boot(MachineKind kind) {
    Machine::Options options;
    options.kind = kind;
    auto machine = Machine::Start(options, std::make_unique<SimulatedMemory>(world_));
    EXPECT_TRUE(machine.ok()) << machine.status();
    return *std::move(machine);
  }

  void Command(Machine& machine, PackMlCommand command) {
    const std::uint16_t values[] = {static_cast<std::uint16_t>(command), 1};
    EXPECT_EQ(machine.Write(holding::kCommand, values), ModbusException::kNone);
    EXPECT_EQ(machine.HoldingRegisters()[holding::kCommandRequest], 0);
  }

  // Lets time pass with the controller alive.
  void Run(Machine& machine, double seconds) {
    for (double left = seconds; left > 1e-9; left -= 0.01) {
      Beat(machine);
      machine.Advance(std::min(left, 0.01), 0.01);
    }
  }

  void Beat(Machine& machine) {
    const std::uint16_t beat[] = {++heartbeat_};
    machine.Write(holding::kControllerHeartbeat, beat);
  }

  void Start(Machine& machine) {
    Command(machine, PackMlCommand::kReset);
    Run(machine, 0.3);
    Command(machine, PackMlCommand::kStart);
    Run(machine, 0.3);
    ASSERT_EQ(machine.Status().state, PackMlState::kExecute);
  }

  ModbusException Order(Machine& machine, const Job& job, std::uint32_t number) {
    const auto encoded = EncodeJob(job, number);
    for (const auto& page : encoded->outline_pages) {
      EXPECT_EQ(machine.Write(holding::kOutlinePage, page), ModbusException::kNone);
    }
    EXPECT_EQ(machine.Write(holding::kJob, encoded->registers), ModbusException::kNone);
    return machine.Write(holding::kSequenceNumber, SplitWords(number));
  }

  World world_;
  std::uint16_t heartbeat_ = 0;
};

TEST_F(MachineTest, CrosscutTakesFeedClampAndFourSeconds) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 1);
  EXPECT_EQ(saw->Status().accepted, 1u);
  Run(*saw, 6.45);
  EXPECT_TRUE(world_.cuts.empty());
  EXPECT_NEAR(saw->Status().progress, 6.45 / 6.5, 0.01);
  Run(*saw, 0.1);
  ASSERT_EQ(world_.cuts.size(), 1u);
  EXPECT_EQ(world_.cuts[0].part, "leg-1");
  EXPECT_NEAR(world_.cuts[0].length, 0.6, 1e-9);
  EXPECT_EQ(saw->Status().done, 1u);
  EXPECT_EQ(saw->Status().result, JobResult::kDone);
  EXPECT_NEAR(saw->Status().seconds, 0.6 / 0.3 + 0.5 + 4.0, 1e-9);
  // The same board is fed on from where it is.
  Order(*saw, CrosscutJob("leg-2", 0.903, 0.3), 2);
  Run(*saw, 6.0);
  EXPECT_NEAR(saw->Status().seconds, 0.303 / 0.3 + 0.5 + 4.0, 1e-6);
}

TEST_F(MachineTest, JigsawFollowsTheOutlineAtTwentyMillimetresASecond) {
  auto jigsaw = Boot(MachineKind::kJigsaw);
  Start(*jigsaw);
  Order(*jigsaw, OutlineJob("seat", 0.3, 20), 1);
  Run(*jigsaw, 61.0);
  ASSERT_EQ(world_.cuts.size(), 1u);
  EXPECT_NEAR(world_.cuts[0].length, 1.2, 1e-4);
  EXPECT_NEAR(jigsaw->Status().seconds, 60.0, 0.01);
}

TEST_F(MachineTest, ANumberIsTakenOnce) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.3, 0.3), 4);
  EXPECT_EQ(Order(*saw, CrosscutJob("leg-1", 0.3, 0.3), 4), ModbusException::kNone);
  EXPECT_EQ(Order(*saw, CrosscutJob("leg-2", 0.6, 0.3), 5), ModbusException::kBusy);
  Run(*saw, 10);
  for (const std::uint32_t number : {4u, 3u, 1u, 0u}) {
    EXPECT_EQ(Order(*saw, CrosscutJob("leg-1", 0.3, 0.3), number), ModbusException::kNone);
    Run(*saw, 10);
  }
  EXPECT_EQ(world_.cuts.size(), 1u);
}

TEST_F(MachineTest, RefusalsUseUpTheirNumberAndCutNothing) {
  auto saw = Boot(MachineKind::kChopSaw);
  Order(*saw, CrosscutJob("leg-1", 0.3, 0.3), 1);
  EXPECT_EQ(saw->Status().result, JobResult::kWrongState);
  Start(*saw);
  Order(*saw, OutlineJob("seat", 0.3, 3), 2);
  EXPECT_EQ(saw->Status().result, JobResult::kParametersRefused);
  Order(*saw, CrosscutJob("leg-1", 9.0, 0.3), 3);
  EXPECT_EQ(saw->Status().result, JobResult::kParametersRefused);
  saw->Write(holding::kSequenceNumber, SplitWords(4));  // the parameters are those of 3
  EXPECT_EQ(saw->Status().result, JobResult::kChecksumMismatch);
  EXPECT_EQ(saw->Status().done, 4u);
  EXPECT_EQ(saw->Status().accepted, 4u);
  EXPECT_TRUE(world_.cuts.empty());
}

TEST_F(MachineTest, WritesOutsideTheMapAreRefused) {
  auto saw = Boot(MachineKind::kChopSaw);
  const std::uint16_t one[] = {1};
  EXPECT_EQ(saw->Write(-1, one), ModbusException::kIllegalAddress);
  EXPECT_EQ(saw->Write(holding::kCount, one), ModbusException::kIllegalAddress);
  EXPECT_EQ(saw->Write(holding::kOutlinePage + 1, one), ModbusException::kIllegalAddress);
  EXPECT_EQ(saw->Write(holding::kSequenceNumber, one), ModbusException::kIllegalValue);
  EXPECT_EQ(saw->Write(holding::kSequenceNumber + 1, one), ModbusException::kIllegalValue);
  const std::uint16_t odd[] = {0, 1, 2};
  EXPECT_EQ(saw->Write(holding::kOutlinePage, odd), ModbusException::kIllegalValue);
  const std::uint16_t beyond[] = {200, 0, 0, 0, 0};
  EXPECT_EQ(saw->Write(holding::kOutlinePage, beyond), ModbusException::kIllegalValue);
}

TEST_F(MachineTest, WithoutTheControllersHeartbeatACutIsFinishedThenHeld) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.3, 0.3), 1);
  Run(*saw, 1.6);  // the blade has begun
  saw->Advance(2.1, 2.1);
  saw->Advance(0.1, 0.1);
  EXPECT_EQ(saw->Status().state, PackMlState::kHolding);
  EXPECT_EQ(saw->Status().hold_reason, HoldReason::kControllerLost);
  saw->Advance(10, 10);
  EXPECT_EQ(saw->Status().state, PackMlState::kHeld);
  EXPECT_EQ(world_.cuts.size(), 1u);
  EXPECT_EQ(saw->Status().done, 1u);
  Run(*saw, 20);  // the heartbeat alone does not resume
  EXPECT_EQ(saw->Status().state, PackMlState::kHeld);
}

TEST_F(MachineTest, WhileFeedingAHoldStopsAtOnceAndUnholdGoesOn) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("rail", 3.0, 3.0), 1);
  Run(*saw, 5.0);
  Command(*saw, PackMlCommand::kHold);
  Run(*saw, 60);
  EXPECT_EQ(saw->Status().state, PackMlState::kHeld);
  EXPECT_EQ(saw->Status().hold_reason, HoldReason::kCommand);
  EXPECT_TRUE(world_.cuts.empty());
  Command(*saw, PackMlCommand::kUnhold);
  Run(*saw, 9.9);
  EXPECT_EQ(world_.cuts.size(), 1u);
}

TEST_F(MachineTest, TheJigsawStopsInItsKerfAndGoesOn) {
  auto jigsaw = Boot(MachineKind::kJigsaw);
  Start(*jigsaw);
  Order(*jigsaw, OutlineJob("seat", 0.1, 5), 1);
  Run(*jigsaw, 10);
  jigsaw->Advance(2.1, 2.1);
  jigsaw->Advance(30, 30);
  EXPECT_EQ(jigsaw->Status().state, PackMlState::kHeld);
  EXPECT_TRUE(world_.cuts.empty());
  Command(*jigsaw, PackMlCommand::kUnhold);
  Run(*jigsaw, 10.5);
  EXPECT_EQ(world_.cuts.size(), 1u);
}

TEST_F(MachineTest, StopTellsWhetherTheMaterialWasTouched) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 1);
  Run(*saw, 1.0);
  Command(*saw, PackMlCommand::kStop);
  Run(*saw, 1.0);
  EXPECT_EQ(saw->Status().state, PackMlState::kStopped);
  EXPECT_EQ(saw->Status().result, JobResult::kInterruptedBefore);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 2);
  Run(*saw, 3.0);
  Command(*saw, PackMlCommand::kStop);  // the blade is in: it finishes
  Run(*saw, 5.0);
  EXPECT_EQ(saw->Status().result, JobResult::kDone);
  EXPECT_EQ(world_.cuts.size(), 1u);
}

TEST_F(MachineTest, TheEmergencyStopAbortsAndHoldsClearOff) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 1);
  Run(*saw, 3.0);
  saw->SetEmergencyStop(true);
  Run(*saw, 1.0);
  EXPECT_EQ(saw->Status().state, PackMlState::kAborted);
  EXPECT_EQ(saw->Status().result, JobResult::kInterruptedDuring);
  EXPECT_EQ(saw->Status().hold_reason, HoldReason::kEmergencyStop);
  Command(*saw, PackMlCommand::kClear);
  Run(*saw, 1.0);
  EXPECT_EQ(saw->Status().state, PackMlState::kAborted);
  saw->SetEmergencyStop(false);
  Command(*saw, PackMlCommand::kClear);
  Run(*saw, 1.0);
  EXPECT_EQ(saw->Status().state, PackMlState::kStopped);
  EXPECT_TRUE(world_.cuts.empty());
}

TEST_F(MachineTest, RestartedWithAJobItWaitsForCommandsThenCutsOnce) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 1);
  Run(*saw, 1.0);
  saw = Boot(MachineKind::kChopSaw);
  EXPECT_EQ(saw->Status().boot_epoch, 2u);
  EXPECT_EQ(saw->Status().state, PackMlState::kAborted);
  EXPECT_EQ(saw->Status().accepted, 1u);
  EXPECT_EQ(saw->Status().done, 0u);
  Run(*saw, 60);
  EXPECT_TRUE(world_.cuts.empty());
  Command(*saw, PackMlCommand::kClear);
  Run(*saw, 0.5);
  Start(*saw);
  Run(*saw, 7.0);
  EXPECT_EQ(world_.cuts.size(), 1u);
  EXPECT_EQ(saw->Status().done, 1u);
}

TEST_F(MachineTest, AMemoryThatIsFullTakesNoNumber) {
  auto saw = Boot(MachineKind::kChopSaw);
  Start(*saw);
  world_.full = true;
  EXPECT_EQ(Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 1), ModbusException::kFailure);
  EXPECT_EQ(saw->Status().accepted, 0u);
  world_.full = false;
  EXPECT_EQ(Order(*saw, CrosscutJob("leg-1", 0.6, 0.6), 1), ModbusException::kNone);
  world_.full = true;  // and a machine that cannot remember does not lower its blade
  Run(*saw, 20);
  EXPECT_TRUE(world_.cuts.empty());
  EXPECT_EQ(saw->Status().done, 0u);
  EXPECT_EQ(saw->Status().state, PackMlState::kAborted);
}

}  // namespace
}  // namespace mortise::hwbridge
