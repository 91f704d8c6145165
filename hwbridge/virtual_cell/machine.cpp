#include "hwbridge/virtual_cell/machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/logging.h"

namespace mortise::hwbridge {
namespace {

constexpr double kOwnHeartbeatPeriod = 0.1;  // s
constexpr double kRounding = 2e-6;           // m, of lengths sent in whole micrometres

}  // namespace

Machine::Machine(const Options& options, std::unique_ptr<MachineMemory> memory)
    : options_(options), memory_(std::move(memory)), outline_(kMaximumOutlinePoints) {}

absl::StatusOr<std::unique_ptr<Machine>> Machine::Start(const Options& options,
                                                        std::unique_ptr<MachineMemory> memory) {
  std::unique_ptr<Machine> machine(new Machine(options, std::move(memory)));
  if (absl::Status status = machine->Boot(); !status.ok()) return status;
  return machine;
}

absl::Status Machine::Boot() {
  absl::StatusOr<MachineRecord> record = memory_->Load();
  if (!record.ok()) return record.status();
  record_ = *std::move(record);
  ++record_.boot_epoch;
  absl::StatusOr<Cut> last_cut = memory_->LastCut();
  if (!last_cut.ok()) return last_cut.status();
  absl::StatusOr<std::uint32_t> cuts = memory_->CutCount();
  if (!cuts.ok()) return cuts.status();
  cuts_ = *cuts;
  // Cut off between the cut and remembering it: the sensor behind the blade settles it.
  if (record_.open_job && last_cut->sequence_number == record_.accepted) {
    record_.open_job.reset();
    record_.tool_in_material = false;
    record_.done = record_.accepted;
    record_.result = JobResult::kDone;
  }
  if (record_.open_job) {
    state_ = PackMlState::kAborted;
    hold_reason_ = HoldReason::kRestarted;
  }
  return memory_->Store(record_);
}

MachineStatus Machine::Status() const {
  MachineStatus status;
  status.kind = options_.kind;
  status.identity = record_.identity;
  status.boot_epoch = record_.boot_epoch;
  status.heartbeat = static_cast<std::uint16_t>(
      static_cast<std::uint64_t>(own_heartbeat_time_ / kOwnHeartbeatPeriod) & 0xffff);
  status.state = state_;
  status.emergency_stop = emergency_stop_;
  status.hold_reason = hold_reason_;
  status.accepted = record_.accepted;
  status.done = record_.done;
  status.result = record_.result;
  status.progress = record_.open_job ? job_elapsed_ / JobTime() : 0.0;
  status.cuts = cuts_;
  status.heartbeat_timeout = options_.heartbeat_timeout;
  status.seconds = record_.seconds;
  return status;
}

void Machine::SetEmergencyStop(bool pressed) {
  emergency_stop_ = pressed;
  if (!pressed || AfterCommand(state_, PackMlCommand::kAbort) == state_) return;
  Enter(PackMlState::kAborting, HoldReason::kEmergencyStop);
}

ModbusException Machine::Write(int address, std::span<const std::uint16_t> values) {
  const int end = address + static_cast<int>(values.size());
  if (!holding::HasAll(address, static_cast<int>(values.size()))) {
    return ModbusException::kIllegalAddress;
  }
  const auto covers = [&](int first) { return address <= first && first < end; };
  const bool number_high = covers(holding::kSequenceNumber);
  const bool number_low = covers(holding::kSequenceNumber + 1);
  if (number_high != number_low) return ModbusException::kIllegalValue;
  if (end > holding::kOutlinePage) {
    if (address != holding::kOutlinePage) return ModbusException::kIllegalAddress;
    return TakeOutlinePage(values);
  }
  if (!CanCommand(address, values)) return ModbusException::kIllegalValue;
  if (covers(holding::kControllerHeartbeat) && values[holding::kControllerHeartbeat - address] !=
                                                   registers_[holding::kControllerHeartbeat]) {
    since_heartbeat_ = 0.0;
  }
  std::copy(values.begin(), values.end(), registers_.begin() + address);
  if (covers(holding::kCommandRequest) && registers_[holding::kCommandRequest] != 0) {
    CarryOutCommand();
  }
  if (!number_high) return ModbusException::kNone;
  return TakeSequenceNumber(
      JoinWords(registers_[holding::kSequenceNumber], registers_[holding::kSequenceNumber + 1]));
}

// Whether what is written to the command and its request, if that is written at all, is one of the
// values that the map gives them.
bool Machine::CanCommand(int address, std::span<const std::uint16_t> values) const {
  const auto written = [&](int at) {
    const bool covered = address <= at && at < address + static_cast<int>(values.size());
    return covered ? values[at - address] : registers_[at];
  };
  const std::uint16_t command = written(holding::kCommand);
  const std::uint16_t request = written(holding::kCommandRequest);
  const auto last = static_cast<std::uint16_t>(PackMlCommand::kClear);
  return command <= last && request <= 1 && (request == 0 || command >= 1);
}

ModbusException Machine::TakeOutlinePage(std::span<const std::uint16_t> values) {
  absl::StatusOr<OutlinePage> page = DecodeOutlinePage(values);
  if (!page.ok()) return ModbusException::kIllegalValue;
  std::copy(page->points.begin(), page->points.end(), outline_.begin() + page->first_point);
  std::copy(values.begin(), values.end(), registers_.begin() + holding::kOutlinePage);
  return ModbusException::kNone;
}

ModbusException Machine::TakeSequenceNumber(std::uint32_t number) {
  if (number <= record_.accepted) return ModbusException::kNone;  // seen before
  if (record_.open_job) return ModbusException::kBusy;
  Job job;
  const JobResult refusal = CheckJob(number, job);
  const MachineRecord before = record_;
  record_.accepted = number;
  if (refusal == JobResult::kNone) {
    record_.open_job = std::move(job);
    record_.tool_in_material = false;
    job_elapsed_ = 0.0;
  } else {
    record_.done = number;
    record_.result = refusal;
    record_.seconds = 0.0;
  }
  if (absl::Status stored = memory_->Store(record_); !stored.ok()) {
    Log(LogLevel::kError, "the machine's memory refused a number", {{"error", stored.ToString()}});
    record_ = before;
    return ModbusException::kFailure;
  }
  return ModbusException::kNone;
}

JobResult Machine::CheckJob(std::uint32_t number, Job& job) const {
  const std::span<const std::uint16_t> registers(registers_);
  absl::StatusOr<Job> decoded =
      DecodeJob(registers.subspan(holding::kJob, kJobRegisters), outline_, number);
  if (absl::IsDataLoss(decoded.status())) return JobResult::kChecksumMismatch;
  if (!decoded.ok() || decoded->kind != options_.kind) return JobResult::kParametersRefused;
  job = *std::move(decoded);
  if (state_ != PackMlState::kExecute) return JobResult::kWrongState;
  if (job.kind == MachineKind::kChopSaw) {
    // A trim cut may leave nothing but sawdust, so a length of zero is fine.
    const bool feasible = job.position > 0.0 && job.length <= job.position + kRounding &&
                          job.position <= options_.longest_feed;
    return feasible ? JobResult::kNone : JobResult::kParametersRefused;
  }
  const bool reachable = std::all_of(job.outline.begin(), job.outline.end(), [&](auto& point) {
    return std::max(std::abs(point.x), std::abs(point.y)) <= options_.table_size;
  });
  const bool feasible = job.outline.size() >= 3 && reachable && OutlineLength(job.outline) > 0.0;
  return feasible ? JobResult::kNone : JobResult::kParametersRefused;
}

void Machine::CarryOutCommand() {
  registers_[holding::kCommandRequest] = 0;
  const auto command = static_cast<PackMlCommand>(registers_[holding::kCommand]);
  if (command == PackMlCommand::kClear && emergency_stop_) return;
  const PackMlState next = AfterCommand(state_, command);
  if (next != state_) Enter(next, HoldReason::kCommand);
}

void Machine::Enter(PackMlState state, HoldReason reason) {
  state_ = state;
  acting_elapsed_ = 0.0;
  const bool halting = state == PackMlState::kHolding || state == PackMlState::kAborting ||
                       state == PackMlState::kStopping || state == PackMlState::kSuspending;
  if (halting) hold_reason_ = reason;
  if (state == PackMlState::kExecute) hold_reason_ = HoldReason::kNone;
  if (state == PackMlState::kAborting && record_.open_job) {
    EndJob(record_.tool_in_material ? JobResult::kInterruptedDuring
                                    : JobResult::kInterruptedBefore);
  }
}

void Machine::Advance(double simulated, double real) {
  own_heartbeat_time_ += real;
  since_heartbeat_ += real;
  if (state_ == PackMlState::kExecute && since_heartbeat_ > options_.heartbeat_timeout) {
    Enter(PackMlState::kHolding, HoldReason::kControllerLost);
  }
  while (simulated > 0.0) {
    const double left = AdvanceState(simulated);
    if (left == simulated) return;  // waiting for the controller
    simulated = left;
  }
}

// Spends some of `simulated` seconds and returns what is left.
double Machine::AdvanceState(double simulated) {
  if (state_ == PackMlState::kExecute || MustFinishCut()) return AdvanceJob(simulated);
  if (!IsActingState(state_)) return simulated;
  const double spent = std::min(simulated, options_.acting_time - acting_elapsed_);
  acting_elapsed_ += spent;
  if (acting_elapsed_ < options_.acting_time) return simulated - spent;
  if (state_ == PackMlState::kStopping && record_.open_job) {
    EndJob(record_.tool_in_material ? JobResult::kInterruptedDuring
                                    : JobResult::kInterruptedBefore);
  }
  Enter(AfterActing(state_));
  return simulated - spent;
}

// A crosscut that has begun is finished in every halting state except Aborting.
bool Machine::MustFinishCut() const {
  const bool halting = state_ == PackMlState::kHolding || state_ == PackMlState::kStopping ||
                       state_ == PackMlState::kSuspending;
  return halting && options_.kind == MachineKind::kChopSaw && record_.open_job &&
         record_.tool_in_material;
}

double Machine::AdvanceJob(double available) {
  if (!record_.open_job) return available;
  const bool cutting = job_elapsed_ >= TimeBeforeCut();
  if (cutting && !record_.tool_in_material) {
    record_.tool_in_material = true;
    if (!memory_->Store(record_).ok()) {
      record_.tool_in_material = false;  // the blade has not moved
      Fault();
      return available;
    }
  }
  const double end = cutting ? JobTime() : TimeBeforeCut();
  const double spent = std::min(available, end - job_elapsed_);
  // Set exactly at a boundary: adding up differences may stay just short of it for ever.
  job_elapsed_ = spent < end - job_elapsed_ ? job_elapsed_ + spent : end;
  if (cutting && job_elapsed_ >= end) FinishCut();
  return available - spent;
}

void Machine::FinishCut() {
  const Job& job = *record_.open_job;
  const double length = job.kind == MachineKind::kChopSaw ? job.length : OutlineLength(job.outline);
  const absl::Status made = memory_->MakeCut(
      {MachineKindName(options_.kind), record_.accepted, job.part, job.stock, length});
  if (!made.ok()) {
    Fault();
    return;
  }
  ++cuts_;
  loaded_stock_ = job.stock;
  fed_ = job.position;
  EndJob(JobResult::kDone);
}

// A result that cannot be remembered is not told either: after a restart the job would be open
// again while the controller had long ordered it anew. A cut that was made is told in any case; the
// sensor behind the blade bears it out.
void Machine::EndJob(JobResult result) {
  MachineRecord ended = record_;
  ended.open_job.reset();
  ended.tool_in_material = false;
  ended.done = record_.accepted;
  ended.result = result;
  ended.seconds = job_elapsed_;
  const absl::Status stored = memory_->Store(ended);
  if (!stored.ok()) {
    Log(LogLevel::kError, "the machine's memory refused a result", {{"error", stored.ToString()}});
    if (result != JobResult::kDone) return;
  }
  record_ = std::move(ended);
  job_elapsed_ = 0.0;
}

// The machine cannot remember any more, so it must not move any more.
void Machine::Fault() {
  Log(LogLevel::kError, "the machine's memory failed; aborting");
  Enter(PackMlState::kAborting, HoldReason::kRestarted);
}

double Machine::TimeBeforeCut() const {
  if (options_.kind == MachineKind::kJigsaw) return 0.0;
  const Job& job = *record_.open_job;
  const double travel = job.stock == loaded_stock_ ? std::abs(job.position - fed_) : job.position;
  return travel / options_.feed_speed + options_.clamp_time;
}

double Machine::JobTime() const {
  if (options_.kind == MachineKind::kJigsaw) {
    return OutlineLength(record_.open_job->outline) / options_.outline_speed;
  }
  return TimeBeforeCut() + options_.crosscut_time;
}

}  // namespace mortise::hwbridge
