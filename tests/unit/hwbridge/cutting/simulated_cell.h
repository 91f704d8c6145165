// A machine, the line to it and time itself, in process and under the control of a test: messages
// get lost, late or answered in vain, either side dies at any moment, and hours pass in no time.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "hwbridge/cutting/clock.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/machine_link.h"
#include "hwbridge/virtual_cell/machine.h"

namespace mortise::hwbridge {

struct MachineCrash {};
struct BridgeCrash {};

// What survives a power loss of the machine: its memory, and the material.
struct World {
  std::optional<MachineRecord> record;
  std::vector<Cut> cuts;
  bool full = false;              // the memory refuses to store
  std::function<void()> on_step;  // before and after each effect; may throw MachineCrash
};

class SimulatedMemory : public MachineMemory {
 public:
  explicit SimulatedMemory(World& world) : world_(world) {}
  absl::StatusOr<MachineRecord> Load() override {
    if (world_.record) return *world_.record;
    MachineRecord fresh;
    fresh.identity = 7;
    return fresh;
  }
  absl::Status Store(const MachineRecord& record) override {
    Step();
    if (world_.full) return StorageFailed("memory", "is full");
    world_.record = record;
    Step();
    return absl::OkStatus();
  }
  absl::Status MakeCut(const Cut& cut) override {
    Step();
    world_.cuts.push_back(cut);
    Step();
    return absl::OkStatus();
  }
  absl::StatusOr<Cut> LastCut() override {
    return world_.cuts.empty() ? Cut{} : world_.cuts.back();
  }
  absl::StatusOr<std::uint32_t> CutCount() override {
    return static_cast<std::uint32_t>(world_.cuts.size());
  }

 private:
  void Step() {
    if (world_.on_step) world_.on_step();
  }
  World& world_;
};

// The machine and time. A machine that crashes is off for three seconds and then starts again.
class SimulatedPlant : public Clock {
 public:
  explicit SimulatedPlant(MachineKind kind) { options_.kind = kind; }

  double Now() const override { return now_; }

  void Advance(double seconds) {
    for (double left = seconds; left > 1e-9; left -= kSlice) Slice(std::min(left, kSlice));
  }

  void PowerOff() {
    machine_.reset();
    on_again_ = now_ + 3.0;
  }

  // Runs `use` on the machine; false if it is off or dies.
  bool WithMachine(const std::function<void(Machine&)>& use) {
    try {
      if (!machine_ && now_ >= on_again_) {
        auto started = Machine::Start(options_, std::make_unique<SimulatedMemory>(world));
        if (started.ok()) machine_ = *std::move(started);
      }
      if (machine_) use(*machine_);
    } catch (const MachineCrash&) {
      PowerOff();
    }
    return machine_ != nullptr;
  }

  // A write that will arrive later.
  void Deliver(double delay, int address, std::span<const std::uint16_t> values) {
    late_.push_back({now_ + delay, address, {values.begin(), values.end()}});
  }

  World world;

 private:
  static constexpr double kSlice = 0.05;  // s
  struct LateWrite {
    double time;
    int address;
    std::vector<std::uint16_t> values;
  };

  void Slice(double seconds) {
    now_ += seconds;
    WithMachine([&](Machine& machine) { machine.Advance(seconds, seconds); });
    std::deque<LateWrite> waiting;
    for (LateWrite& write : std::exchange(late_, {})) {
      if (write.time > now_) {
        waiting.push_back(std::move(write));
      } else {
        WithMachine([&](Machine& machine) { machine.Write(write.address, write.values); });
      }
    }
    late_ = std::move(waiting);
  }

  Machine::Options options_;
  std::unique_ptr<Machine> machine_;
  double now_ = 0.0;
  double on_again_ = 0.0;
  std::deque<LateWrite> late_;
};

enum class LineFault { kNone, kLoseRequest, kLoseAnswer, kDelay };

class SimulatedLink : public MachineLink {
 public:
  explicit SimulatedLink(SimulatedPlant& plant) : plant_(plant) {}

  // Called before and after each request; may throw BridgeCrash.
  std::function<void()> on_step;
  // Which fault befalls the next request.
  std::function<LineFault()> next_fault;
  double late_by = 4.0;     // s, of a request that is delayed
  int numbers_written = 0;  // requests that carried a sequence number

  absl::Status Write(int address, std::span<const std::uint16_t> values) override {
    if (address == holding::kSequenceNumber) ++numbers_written;
    absl::Status refused;
    const absl::Status line = Exchange(
        [&](Machine& machine) {
          const ModbusException exception = machine.Write(address, values);
          if (exception == ModbusException::kNone) return;
          refused = PreconditionFailed("MACHINE_REFUSED", "exception");
        },
        [&] { plant_.Deliver(late_by, address, values); });
    return line.ok() ? refused : line;
  }

  absl::StatusOr<MachineStatus> ReadStatus() override {
    StatusRegisters registers{};
    const absl::Status line =
        Exchange([&](Machine& machine) { registers = EncodeStatus(machine.Status()); }, [] {});
    if (!line.ok()) return line;
    return DecodeStatus(registers);
  }

 private:
  absl::Status Exchange(const std::function<void(Machine&)>& request,
                        const std::function<void()>& delay) {
    if (on_step) on_step();
    const LineFault fault = next_fault ? next_fault() : LineFault::kNone;
    bool answered = false;
    if (fault == LineFault::kNone || fault == LineFault::kLoseAnswer) {
      answered = plant_.WithMachine(request) && fault == LineFault::kNone;
    } else if (fault == LineFault::kDelay) {
      delay();
    }
    if (!answered) plant_.Advance(0.5);  // the time-out
    if (on_step) on_step();
    return answered ? absl::OkStatus() : PeerUnavailable("machine", "timed out");
  }

  SimulatedPlant& plant_;
};

// A folder that is gone when the test is over.
class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(std::filesystem::temp_directory_path() / ("hwbridge-" + NewIdentifier())) {
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline Job CrosscutJob(std::string part, double position, double length) {
  Job job;
  job.kind = MachineKind::kChopSaw;
  job.part = std::move(part);
  job.stock = "board-1";
  job.position = position;
  job.length = length;
  return job;
}

// A square of the given side with `points` points a side.
inline Job OutlineJob(std::string part, double side, int points) {
  Job job;
  job.kind = MachineKind::kJigsaw;
  job.part = std::move(part);
  job.stock = "sheet-1";
  const OutlinePoint corners[] = {{0, 0}, {side, 0}, {side, side}, {0, side}, {0, 0}};
  for (int edge = 0; edge < 4; ++edge) {
    for (int i = 0; i < points; ++i) {
      const double t = static_cast<double>(i) / points;
      job.outline.push_back({corners[edge].x + t * (corners[edge + 1].x - corners[edge].x),
                             corners[edge].y + t * (corners[edge + 1].y - corners[edge].y)});
    }
  }
  return job;
}

}  // namespace mortise::hwbridge
