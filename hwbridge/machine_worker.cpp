#include "hwbridge/machine_worker.h"

#include <array>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::hwbridge {
namespace {

// The command that brings a waiting machine nearer to Execute.
std::optional<PackMlCommand> TowardsExecute(PackMlState state) {
  switch (state) {
    case PackMlState::kAborted:
      return PackMlCommand::kClear;
    case PackMlState::kStopped:
    case PackMlState::kComplete:
      return PackMlCommand::kReset;
    case PackMlState::kIdle:
      return PackMlCommand::kStart;
    case PackMlState::kHeld:
      return PackMlCommand::kUnhold;
    case PackMlState::kSuspended:
      return PackMlCommand::kUnsuspend;
    default:
      return std::nullopt;
  }
}

}  // namespace

MachineWorker::MachineWorker(const Options& options, MachineLink& link, Journal& journal,
                             const Clock& clock)
    : options_(options),
      link_(link),
      journal_(journal),
      clock_(clock),
      handshake_(options.handshake, link, journal),
      last_answer_(clock.Now()),
      last_machine_beat_(clock.Now()),
      last_work_(clock.Now()) {
  HoldOpenCuts("the bridge restarted");
}

void MachineWorker::Cycle() {
  absl::StatusOr<MachineStatus> status = Exchange();
  if (!status.ok()) {
    NoteSilence(status.status());
    return;
  }
  NoteStatus(*status);
  TakeStep(*status);
}

absl::StatusOr<MachineStatus> MachineWorker::Exchange() {
  const std::array<std::uint16_t, 1> beat = {++heartbeat_};
  MORTISE_RETURN_IF_ERROR(link_.Write(holding::kControllerHeartbeat, beat));
  MORTISE_ASSIGN_OR_RETURN(const MachineStatus status, link_.ReadStatus());
  const double now = clock_.Now();
  if (status.heartbeat != machine_heartbeat_) {
    machine_heartbeat_ = status.heartbeat;
    last_machine_beat_ = now;
  }
  if (now - last_machine_beat_ > options_.line_lost_after) {
    return PeerUnavailable(options_.name, "its heartbeat stands still");
  }
  if (status.kind != options_.kind) {
    return PreconditionFailed("WRONG_MACHINE", absl::StrCat(options_.name, " is another machine"));
  }
  last_answer_ = now;
  return status;
}

void MachineWorker::NoteSilence(const absl::Status& status) {
  if (clock_.Now() - last_answer_ <= options_.line_lost_after) return;
  {
    const std::lock_guard lock(mutex_);
    if (status_) {
      Log(LogLevel::kWarning, "the line to a machine is lost",
          {{"machine", options_.name}, {"error", status.ToString()}});
    }
    status_.reset();
  }
  HoldOpenCuts("the line to the machine is lost");
}

void MachineWorker::NoteStatus(const MachineStatus& status) {
  bool was_running = false;
  {
    const std::lock_guard lock(mutex_);
    if (!status_) {
      Log(LogLevel::kInfo, "the line to a machine stands",
          {{"machine", options_.name}, {"state", PackMlStateName(status.state)}});
    }
    status_ = status;
    was_running = running_;
  }
  const bool restarted = boot_epoch_ != 0 && status.boot_epoch != boot_epoch_;
  boot_epoch_ = status.boot_epoch;
  if (status.emergency_stop) {
    HoldOpenCuts("the emergency stop is pressed");
  } else if (restarted) {
    HoldOpenCuts("the machine restarted");
  } else if (was_running && status.state != PackMlState::kExecute) {
    HoldOpenCuts(absl::StrCat("the machine went to ", PackMlStateName(status.state), " (",
                              HoldReasonName(status.hold_reason), ")"));
  }
}

void MachineWorker::TakeStep(const MachineStatus& status) {
  for (const CutOrder& order : journal_.OpenCuts(options_.name)) Settle(status, order);
  if (journal_.OpenCuts(options_.name).empty()) {
    StopIdleMachine(status);
    return;
  }
  last_work_ = clock_.Now();
  const std::optional<CutOrder> order = NextCut();
  if (!order || IsHeld(order->key.work_order) || !ReadyToCut(status)) return;
  const absl::Status advanced = handshake_.Advance(*order, status);
  if (advanced.ok() || absl::IsUnavailable(advanced)) return;
  HoldOpenCuts(advanced.ToString());
}

// The cut that the machine was given a number for and that has not ended, held or not: nothing else
// may be given to the machine before. Else the first one that is not held.
std::optional<CutOrder> MachineWorker::NextCut() const {
  const std::vector<CutOrder> open = journal_.OpenCuts(options_.name);
  for (const CutOrder& order : open) {
    const std::vector<Intent> intents = journal_.Intents(order.key);
    if (!intents.empty() && intents.back().result == JobResult::kNone) return order;
  }
  for (const CutOrder& order : open) {
    if (!IsHeld(order.key.work_order)) return order;
  }
  return std::nullopt;
}

// A machine without orders is stopped after a while, not left waiting in Execute.
void MachineWorker::StopIdleMachine(const MachineStatus& status) {
  const bool idle = clock_.Now() - last_work_ >= options_.stop_after_idle;
  if (!idle || status.state != PackMlState::kExecute) return;
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  Command(PackMlCommand::kStop);
}

// Reports the cut if it has ended.
void MachineWorker::Settle(const MachineStatus& status, const CutOrder& order) {
  absl::StatusOr<std::optional<CutEnd>> settled = handshake_.Settle(order, status);
  absl::Status failure = settled.status();
  if (settled.ok()) {
    if (!settled->has_value()) return;
    const CutEnd& end = **settled;
    failure = journal_.AddReport(order.key, end.outcome, end.message, end.seconds).status();
    if (end.outcome != CutOutcome::kDone) HoldOpenCuts(end.message);
  }
  if (!failure.ok()) HoldOpenCuts(failure.ToString());
}

// Whether the machine is in Execute; commands it there if not.
bool MachineWorker::ReadyToCut(const MachineStatus& status) {
  if (status.emergency_stop) return false;
  if (status.state == PackMlState::kExecute) {
    const std::lock_guard lock(mutex_);
    running_ = true;
    return true;
  }
  if (const auto command = TowardsExecute(status.state)) Command(*command);
  return false;
}

// A command that is lost is given again on the next scan, where the state still asks for it.
void MachineWorker::Command(PackMlCommand command) {
  const std::array<std::uint16_t, 2> values = {static_cast<std::uint16_t>(command), 1};
  const absl::Status status = link_.Write(holding::kCommand, values);
  if (status.ok()) return;
  Log(LogLevel::kWarning, "a command to a machine failed",
      {{"machine", options_.name}, {"error", status.ToString()}});
}

void MachineWorker::HoldOpenCuts(std::string_view because) { Hold("", because); }

void MachineWorker::Hold(std::string_view work_order, std::string_view because) {
  const std::vector<CutOrder> open = journal_.OpenCuts(options_.name);
  const std::lock_guard lock(mutex_);
  bool changed = !work_order.empty() && held_orders_.insert(std::string(work_order)).second;
  for (const CutOrder& order : open) {
    if (!work_order.empty()) break;
    changed |= held_orders_.insert(order.key.work_order).second;
  }
  if (work_order.empty()) running_ = false;
  if (!changed) return;
  held_because_ = std::string(because);
  Log(LogLevel::kWarning, "cuts are held",
      {{"machine", options_.name}, {"because", std::string(because)}});
}

absl::Status MachineWorker::Resume(std::string_view work_order) {
  const std::lock_guard lock(mutex_);
  if (!status_ || status_->emergency_stop) {
    return PreconditionFailed("LINE_LOST",
                              absl::StrCat(options_.name,
                                           " cannot be reached, or its emergency stop is "
                                           "pressed; its cuts stay held"));
  }
  if (work_order.empty()) {
    held_orders_.clear();
  } else {
    held_orders_.erase(std::string(work_order));
  }
  Log(LogLevel::kInfo, "cuts are resumed", {{"machine", options_.name}});
  return absl::OkStatus();
}

bool MachineWorker::IsHeld(const std::string& work_order) const {
  const std::lock_guard lock(mutex_);
  return held_orders_.contains(work_order);
}

MachineView MachineWorker::View() const {
  const std::optional<CutOrder> next = NextCut();
  const bool open = !journal_.OpenCuts(options_.name).empty();
  const bool held = open && (!next || IsHeld(next->key.work_order));
  const std::lock_guard lock(mutex_);
  MachineView view;
  view.name = options_.name;
  view.kind = options_.kind;
  view.online = status_.has_value();
  if (status_) view.state = PackMlStateName(status_->state);
  view.held = held;
  if (view.held) view.held_because = held_because_;
  return view;
}

absl::Status MachineWorker::AdoptNumbers() {
  const std::lock_guard lock(mutex_);
  if (!status_) return PreconditionFailed("LINE_LOST", options_.name + " cannot be reached");
  return journal_.AdoptNumber(options_.name, status_->accepted);
}

}  // namespace mortise::hwbridge
