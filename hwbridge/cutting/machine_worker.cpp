#include "hwbridge/cutting/machine_worker.h"

#include <algorithm>
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
      handshake_(options.handshake, link, journal, clock),
      watch_(journal.LastEcho(options.name)),
      patience_(options.cut_patience, options.line_lost_after),
      last_answer_(clock.Now()),
      last_machine_beat_(clock.Now()),
      last_work_(clock.Now()),
      alarm_(journal.Alarm(options.name)),
      alarm_is_kept_(true) {
  HoldOpenCuts(alarm_.empty() ? "the bridge restarted" : alarm_);
}

void MachineWorker::Cycle() {
  (void)KeepAlarm();  // the disk may take now what it did not take before
  const absl::StatusOr<MachineStatus> status = Exchange();
  if (!status.ok()) {
    NoteFailure(status.status());
    return;
  }
  NoteStatus(*status);
  const std::optional<std::string> contradiction = watch_.Note(*status);
  if (contradiction) RaiseAlarm(*contradiction);
  TakeStep(*status, contradiction);
}

// UNAVAILABLE: the line. Everything else is what the machine says.
absl::StatusOr<MachineStatus> MachineWorker::Exchange() {
  const std::array<std::uint16_t, 1> beat = {++heartbeat_};
  MORTISE_RETURN_IF_ERROR(link_.Write(holding::kControllerHeartbeat, beat));
  MORTISE_ASSIGN_OR_RETURN(const MachineStatus status, link_.ReadStatus());
  NoteBeat(status);
  if (status.kind != options_.kind) {
    return PreconditionFailed(
        "WRONG_MACHINE",
        absl::StrCat("the machine says that it is a ", MachineKindName(status.kind), ", but a ",
                     MachineKindName(options_.kind), " is expected"));
  }
  if (status.heartbeat_timeout <= 0.0) {
    return PreconditionFailed("NO_TIMEOUT",
                              "the machine's heartbeat timeout is 0: it would not hold by itself");
  }
  if (clock_.Now() - last_machine_beat_ > options_.line_lost_after) {
    return PreconditionFailed("HEARTBEAT_STANDS", "the machine's heartbeat stands still");
  }
  return status;
}

void MachineWorker::NoteBeat(const MachineStatus& status) {
  const double now = clock_.Now();
  last_answer_ = now;
  if (!contact_) {
    contact_ = true;
    beats_ = false;
    last_machine_beat_ = now;
  } else if (status.heartbeat != machine_heartbeat_) {
    beats_ = true;
    last_machine_beat_ = now;
  }
  machine_heartbeat_ = status.heartbeat;
}

// A line that fails may be back with the next scan; a machine that cannot be understood is held at
// once.
void MachineWorker::NoteFailure(const absl::Status& status) {
  const std::string text(status.message());
  const bool refused = DetailOf(status).reason == "MACHINE_REFUSED";
  if (absl::IsUnavailable(status) || refused) {
    if (clock_.Now() - last_answer_ <= options_.line_lost_after) return;
    contact_ = false;
    LoseLine(absl::StrCat(
        refused ? "the machine refuses to be read: " : "the line to the machine is lost: ", text));
    return;
  }
  const std::string trouble = absl::IsInvalidArgument(status)
                                  ? absl::StrCat("the machine's status makes no sense: ", text)
                                  : text;
  last_answer_ = clock_.Now();
  if (absl::IsInvalidArgument(status)) contact_ = false;  // nor did its heartbeat arrive
  RaiseAlarm(trouble);
  LoseLine(trouble);
}

// The first trouble stays until the line stands.
void MachineWorker::LoseLine(const std::string& trouble) {
  bool news = false;
  {
    const std::lock_guard lock(mutex_);
    news = line_trouble_.empty();
    if (news) line_trouble_ = trouble;
    status_.reset();
  }
  if (news) {
    Log(LogLevel::kWarning, "a machine cannot be worked",
        {{"machine", options_.name}, {"because", trouble}});
  }
  HoldOpenCuts(trouble);
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
    line_trouble_.clear();
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

void MachineWorker::TakeStep(const MachineStatus& status,
                             const std::optional<std::string>& contradiction) {
  for (const CutOrder& order : journal_.OpenCuts(options_.name)) {
    Settle(status, order, contradiction);
  }
  if (const std::string alarm = Alarm(); !alarm.empty()) {
    HoldOpenCuts(alarm);  // those too that came since
    return;
  }
  TakeResume();
  if (journal_.OpenCuts(options_.name).empty()) {
    StopIdleMachine(status);
    return;
  }
  last_work_ = clock_.Now();
  const std::optional<CutOrder> order = NextCut();
  if (!order || TakesTooLong(*order, status)) return;
  if (IsHeld(order->key.work_order) || !ReadyToCut(status)) return;
  const absl::Status advanced = handshake_.Advance(*order, status);
  if (advanced.ok() || absl::IsUnavailable(advanced)) return;
  RaiseAlarm(std::string(advanced.message()));
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
  if (status.state != PackMlState::kExecute) {
    urging_ = {};
    return;
  }
  if (clock_.Now() - last_work_ < options_.stop_after_idle) return;
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  Urge(PackMlCommand::kStop, status);
}

// Reports the cut if it has ended.
void MachineWorker::Settle(const MachineStatus& status, const CutOrder& order,
                           const std::optional<std::string>& contradiction) {
  absl::StatusOr<std::optional<CutEnd>> settled = handshake_.Settle(order, status, contradiction);
  absl::Status failure = settled.status();
  if (settled.ok()) {
    if (!settled->has_value()) return;
    const CutEnd& end = **settled;
    // Before the report, after which nobody asks any more why this number is unknown.
    const std::string because = journal_.Intents(order.key).back().because;
    if (!because.empty()) RaiseAlarm(because);
    failure = journal_.AddReport(order.key, end.outcome, end.message, end.seconds).status();
    if (end.outcome != CutOutcome::kDone) HoldOpenCuts(end.message);
  }
  if (!failure.ok()) HoldOpenCuts(failure.ToString());
}

// Raises the alarm if so. A cut that was accepted and then held is still the machine's to end; what
// became of it stays open, as only its echo can tell.
bool MachineWorker::TakesTooLong(const CutOrder& order, const MachineStatus& status) {
  const std::vector<Intent> intents = journal_.Intents(order.key);
  if (IsHeld(order.key.work_order) && (intents.empty() || !intents.back().accepted)) {
    patience_.Renew();
    return false;
  }
  const auto because = patience_.Note(order, status.state, clock_.Now());
  if (because) RaiseAlarm(*because);
  return because.has_value();
}

// Whether the machine is in Execute; commands it there if not. A status that does not live, as one
// that some device between keeps repeating, is not acted on.
bool MachineWorker::ReadyToCut(const MachineStatus& status) {
  if (status.emergency_stop || !beats_) return false;
  if (status.state == PackMlState::kExecute) {
    urging_ = {};
    const std::lock_guard lock(mutex_);
    running_ = true;
    return true;
  }
  if (const auto command = TowardsExecute(status.state)) Urge(*command, status);
  return false;
}

// A command that is lost is given again, where the state still asks for it; but not for ever.
void MachineWorker::Urge(PackMlCommand command, const MachineStatus& status) {
  const double now = clock_.Now();
  const bool same = urging_.count > 0 && urging_.command == command;
  if (same && now - urging_.last < options_.command_pace) return;
  if (urging_.count >= options_.commands_in_vain) {
    RaiseAlarm(absl::StrCat("the machine was given ", urging_.count, " commands in vain, and is ",
                            PackMlStateName(status.state)));
    return;
  }
  urging_ = {command, urging_.count + 1, now};
  Command(command);
}

void MachineWorker::Command(PackMlCommand command) {
  const std::array<std::uint16_t, 2> values = {static_cast<std::uint16_t>(command), 1};
  const absl::Status status = link_.Write(holding::kCommand, values);
  if (status.ok()) return;
  Log(LogLevel::kWarning, "a command to a machine failed",
      {{"machine", options_.name}, {"error", status.ToString()}});
}

// The first alarm stays: what comes after it may be its consequence.
void MachineWorker::RaiseAlarm(std::string_view because) {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    if (!alarm_.empty()) return;
    alarm_ = std::string(because);
    alarm_is_kept_ = false;
  }
  Log(LogLevel::kError, "a machine raised the alarm; its cuts are held until somebody has looked",
      {{"machine", options_.name}, {"because", std::string(because)}});
  if (const absl::Status kept = KeepAlarm(); !kept.ok()) {
    Log(LogLevel::kError, "an alarm is not in the journal and would not outlive the bridge",
        {{"machine", options_.name}, {"error", kept.ToString()}});
  }
  HoldOpenCuts(because);
}

// Writes an alarm down that is not, so that it stands after a restart.
absl::Status MachineWorker::KeepAlarm() {
  const std::lock_guard lock(mutex_);
  if (alarm_.empty() || alarm_is_kept_) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(journal_.AddAlarm(options_.name, alarm_));
  alarm_is_kept_ = true;
  return absl::OkStatus();
}

std::string MachineWorker::Alarm() const {
  const std::lock_guard lock(mutex_);
  return alarm_;
}

void MachineWorker::TakeResume() {
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(resumed_, false)) return;
  }
  urging_ = {};
  patience_.Renew();
  handshake_.RenewPatience();
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

// Whether a person can see now what will move. Needs mutex_.
absl::Status MachineWorker::CheckReach() const {
  if (status_ && !status_->emergency_stop) return absl::OkStatus();
  const std::string because = status_                 ? "its emergency stop is pressed"
                              : line_trouble_.empty() ? "it has not answered yet"
                                                      : line_trouble_;
  return PreconditionFailed(
      "LINE_LOST", absl::StrCat(options_.name, " cannot go on: ", because, "; its cuts stay held"));
}

// Needs mutex_, and a line. The journal comes first: an alarm that is cleared here and stands there
// would only hold once more, the other way round nobody would have to look.
absl::Status MachineWorker::EndAlarm() {
  if (alarm_.empty()) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(journal_.ClearAlarm(
      options_.name,
      {status_->identity, status_->boot_epoch, status_->accepted, status_->done, status_->result}));
  alarm_.clear();
  Log(LogLevel::kInfo, "the alarm of a machine is cleared", {{"machine", options_.name}});
  return absl::OkStatus();
}

absl::Status MachineWorker::ClearAlarm() {
  const std::lock_guard lock(mutex_);
  MORTISE_RETURN_IF_ERROR(CheckReach());
  MORTISE_RETURN_IF_ERROR(EndAlarm());
  resumed_ = true;
  return absl::OkStatus();
}

absl::Status MachineWorker::Resume(std::string_view work_order) {
  const std::lock_guard lock(mutex_);
  MORTISE_RETURN_IF_ERROR(CheckReach());
  if (!alarm_.empty() && !work_order.empty() && !HasOpenCuts(work_order)) {
    return PreconditionFailed(
        "ALARM", absl::StrCat(options_.name, " raised the alarm, and holds no cut of ",
                              std::string(work_order), ": ", alarm_,
                              "; look at it, then clear the alarm by the machine's name"));
  }
  MORTISE_RETURN_IF_ERROR(EndAlarm());
  if (work_order.empty()) {
    held_orders_.clear();
  } else {
    held_orders_.erase(std::string(work_order));
  }
  resumed_ = true;
  Log(LogLevel::kInfo, "cuts are resumed", {{"machine", options_.name}});
  return absl::OkStatus();
}

bool MachineWorker::IsHeld(const std::string& work_order) const {
  const std::lock_guard lock(mutex_);
  return held_orders_.contains(work_order);
}

bool MachineWorker::HasOpenCuts(std::string_view work_order) const {
  const std::vector<CutOrder> open = journal_.OpenCuts(options_.name);
  return std::any_of(open.begin(), open.end(),
                     [&](const CutOrder& order) { return order.key.work_order == work_order; });
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
  view.alarm = !alarm_.empty();
  view.held = held || view.alarm;
  if (!view.held) return view;
  view.held_because = !alarm_.empty()          ? alarm_
                      : !line_trouble_.empty() ? line_trouble_
                                               : held_because_;
  return view;
}

absl::Status MachineWorker::AdoptNumbers() {
  const std::lock_guard lock(mutex_);
  if (!status_) return PreconditionFailed("LINE_LOST", options_.name + " cannot be reached");
  return journal_.AdoptNumber(options_.name, status_->accepted);
}

}  // namespace mortise::hwbridge
