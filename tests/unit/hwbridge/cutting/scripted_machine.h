// A machine that says what a test wants, register by register: also what no machine should say.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "hwbridge/cutting/clock.h"
#include "hwbridge/cutting/machine_link.h"
#include "hwbridge/registers/registers.h"

namespace mortise::hwbridge {

// Input registers by what is in them; 32-bit numbers by their low word.
namespace input {
inline constexpr int kVersion = 0;
inline constexpr int kKind = 1;
inline constexpr int kIdentity = 3;
inline constexpr int kBootEpoch = 5;
inline constexpr int kHeartbeat = 6;
inline constexpr int kState = 7;
inline constexpr int kEmergencyStop = 8;
inline constexpr int kHoldReason = 9;
inline constexpr int kAccepted = 11;
inline constexpr int kDone = 13;
inline constexpr int kResult = 14;
inline constexpr int kProgress = 15;
inline constexpr int kHeartbeatTimeout = 18;
}  // namespace input

class ManualClock : public Clock {
 public:
  double Now() const override { return now; }
  double now = 100.0;  // s
};

// Sound and waiting in Execute as it is made; it takes no number by itself.
class ScriptedMachine : public MachineLink {
 public:
  struct NumberWrite {
    std::uint32_t number = 0;
    double time = 0.0;  // s
  };

  explicit ScriptedMachine(const Clock& clock) : clock_(clock) {
    MachineStatus status;
    status.identity = 7;
    status.boot_epoch = 1;
    status.state = PackMlState::kExecute;
    status.heartbeat_timeout = 2.0;
    registers = EncodeStatus(status);
  }

  absl::Status Write(int address, std::span<const std::uint16_t> values) override {
    ++writes[address];
    const absl::Status answer = on_write ? on_write(address, values) : absl::OkStatus();
    if (address == holding::kSequenceNumber) {
      numbers.push_back({JoinWords(values[0], values[1]), clock_.Now()});
    }
    return answer;
  }

  absl::StatusOr<MachineStatus> ReadStatus() override {
    if (heart_beats) ++registers[input::kHeartbeat];
    if (on_read) on_read();
    if (!read_answer.ok()) return read_answer;
    return DecodeStatus(registers);
  }

  // Sets the echo, 16 bits of each number.
  void Echo(std::uint16_t accepted, std::uint16_t done, JobResult result) {
    registers[input::kAccepted] = accepted;
    registers[input::kDone] = done;
    registers[input::kResult] = static_cast<std::uint16_t>(result);
  }

  StatusRegisters registers{};
  bool heart_beats = true;
  absl::Status read_answer;                                                   // not OK: no status
  std::function<void()> on_read;                                              // before each
  std::function<absl::Status(int, std::span<const std::uint16_t>)> on_write;  // its answer
  std::map<int, int> writes;                                                  // by address
  std::vector<NumberWrite> numbers;                                           // as written

 private:
  const Clock& clock_;
};

}  // namespace mortise::hwbridge
