// A virtual machine of the cell: a chop saw with a feeder, or a jigsaw robot.
//
// It behaves as docs/protocol/modbus-registers.md asks of a real one: PackML states, sequence
// numbers taken once and remembered, checksums verified, holding by itself when the controller
// falls silent. It has no thread and no socket; time is what Advance is told. It stops safely: a
// chop saw that is told to hold finishes the cut its blade has begun, a jigsaw stops in its kerf
// and goes on from there.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/registers/packml.h"
#include "hwbridge/registers/registers.h"
#include "hwbridge/virtual_cell/machine_memory.h"

namespace mortise::hwbridge {

// What a write is answered with; the numbers are those of Modbus.
enum class ModbusException : int {
  kNone = 0,
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kFailure = 4,
  kBusy = 6,
  kNoSuchUnit = 11,
};

class Machine {
 public:
  struct Options {
    MachineKind kind = MachineKind::kChopSaw;
    double feed_speed = 0.3;         // m/s, of the feeder
    double clamp_time = 0.5;         // s
    double crosscut_time = 4.0;      // s
    double outline_speed = 0.02;     // m/s, of the jigsaw along the outline
    double longest_feed = 6.5;       // m
    double table_size = 3.0;         // m, of the square the jigsaw reaches
    double acting_time = 0.2;        // s, spent in each PackML state that ends by itself
    double heartbeat_timeout = 2.0;  // s of real time
  };

  // Starts the machine from its memory: the boot epoch grows by one. It wakes in Stopped, or in
  // Aborted if it was cut off with a job open. Fails as the memory does.
  static absl::StatusOr<std::unique_ptr<Machine>> Start(const Options& options,
                                                        std::unique_ptr<MachineMemory> memory);

  // Lets time pass: `simulated` seconds for the mechanics, `real` ones for the heartbeat.
  void Advance(double simulated, double real);

  // Writes holding registers as one request does, and reacts before the answer leaves.
  ModbusException Write(int address, std::span<const std::uint16_t> values);

  std::span<const std::uint16_t> HoldingRegisters() const { return registers_; }
  MachineStatus Status() const;

  // The mushroom button. Pressed, the machine aborts at once and Clear does nothing.
  void SetEmergencyStop(bool pressed);

 private:
  Machine(const Options& options, std::unique_ptr<MachineMemory> memory);
  absl::Status Boot();
  bool CanCommand(int address, std::span<const std::uint16_t> values) const;
  ModbusException TakeOutlinePage(std::span<const std::uint16_t> values);
  ModbusException TakeSequenceNumber(std::uint32_t number);
  JobResult CheckJob(std::uint32_t number, Job& job) const;
  void CarryOutCommand();
  void Enter(PackMlState state, HoldReason reason = HoldReason::kNone);
  double AdvanceState(double simulated);
  double AdvanceJob(double available);
  bool MustFinishCut() const;
  void FinishCut();
  void EndJob(JobResult result);
  void Fault();
  double TimeBeforeCut() const;  // s, of the open job
  double JobTime() const;        // s, of the open job

  Options options_;
  std::unique_ptr<MachineMemory> memory_;
  MachineRecord record_;
  std::array<std::uint16_t, holding::kCount> registers_{};
  std::vector<OutlinePoint> outline_;
  PackMlState state_ = PackMlState::kStopped;
  HoldReason hold_reason_ = HoldReason::kNone;
  bool emergency_stop_ = false;
  double acting_elapsed_ = 0.0;      // s in the present acting state
  double job_elapsed_ = 0.0;         // s of the open job
  double since_heartbeat_ = 0.0;     // s of real time since the controller's last sign of life
  double own_heartbeat_time_ = 0.0;  // s of real time since start
  std::uint32_t cuts_ = 0;
  std::string loaded_stock_;  // the board on the feeder
  double fed_ = 0.0;          // m, how far that board has been fed
};

}  // namespace mortise::hwbridge
