#include "hwbridge/client/bridge_client.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "common/rpc/channel.h"
#include "common/rpc/status_mapping.h"
#include "hwbridge/client/bridge_codec.h"
#include "mortise/v1/fabplanner.grpc.pb.h"

namespace mortise::hwbridge {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds kConnectPatience{2};
constexpr std::chrono::milliseconds kStopLatency{50};

steady_clock::duration Seconds(double seconds) {
  return std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

// What the client and its present line have in common.
struct BridgeClient::Shared {
  Shared(const Options& options_in, Journal& journal_in)
      : options(options_in), journal(journal_in) {}

  const Options options;
  Journal& journal;
  std::shared_ptr<grpc::Channel> channel;
  std::mutex mutex;
  std::condition_variable_any changed;
  long changes = 0;       // guarded by mutex
  bool attached = false;  // guarded by mutex: the fabplanner has answered
  steady_clock::time_point detached_since = steady_clock::now();  // guarded by mutex
};

// One attachment, from dialling to its end.
class BridgeClient::Line {
 public:
  Line(Shared& shared, WorkOrderRunner& runner) : shared_(shared), runner_(runner) {}

  // Returns how the line ended.
  absl::Status Run(std::stop_token stop) {
    MORTISE_RETURN_IF_ERROR(Authorize());
    AwaitConnection(stop);
    const auto stub = v1::FabPlannerService::NewStub(shared_.channel);
    stream_ = stub->AttachBridge(&context_);
    const std::stop_callback cancel(stop, [this] { context_.TryCancel(); });
    if (stream_->Write(Hello())) {
      // Ends with the stream. Cancelling it here would hide why the fabplanner ended it.
      std::jthread reading([this] { ReadAll(); });
      WriteAll(stop);
    }
    const absl::Status status = rpc::FromGrpc(stream_->Finish());
    return failure_.ok() ? status : failure_;
  }

 private:
  // A handshake of TLS goes on only while somebody waits for the channel; a call that is refused at
  // once does not, and each attempt to connect would time out half done. What keeps the channel
  // from its server is told by the call that follows.
  void AwaitConnection(const std::stop_token& stop) {
    const auto end = steady_clock::now() + kConnectPatience;
    while (!stop.stop_requested() && steady_clock::now() < end) {
      if (shared_.channel->WaitForConnected(std::chrono::system_clock::now() + kStopLatency)) {
        return;
      }
    }
  }

  absl::Status Authorize() {
    if (shared_.options.token_file.empty()) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(const std::string token, ReadFile(shared_.options.token_file, 65536));
    context_.AddMetadata("authorization",
                         absl::StrCat("Bearer ", absl::StripAsciiWhitespace(token)));
    return absl::OkStatus();
  }

  v1::BridgeMessage Hello() {
    v1::BridgeMessage message;
    message.mutable_hello()->set_bridge(shared_.options.bridge);
    message.mutable_hello()->set_next_report_number(shared_.journal.NextReportNumber());
    for (const MachineView& view : runner_.Machines()) {
      *message.mutable_hello()->add_machines() = MachineToProto(view);
    }
    return message;
  }

  void ReadAll() {
    v1::PlannerMessage message;
    while (stream_->Read(&message)) {
      NoteAttached();
      const absl::Status taken = Take(message);
      if (taken.ok()) continue;
      // What could not be written down was not taken over: the fabplanner gives it again.
      failure_ = taken;
      context_.TryCancel();
    }
    const std::lock_guard lock(shared_.mutex);
    ended_ = true;
    if (std::exchange(shared_.attached, false)) shared_.detached_since = steady_clock::now();
    shared_.changed.notify_all();
  }

  void NoteAttached() {
    {
      const std::lock_guard lock(shared_.mutex);
      if (std::exchange(shared_.attached, true)) return;
      shared_.changed.notify_all();
    }
    Log(LogLevel::kInfo, "attached to the fabplanner", {{"gateway", shared_.options.gateway}});
    if (shared_.options.on_attached) shared_.options.on_attached();
  }

  absl::Status Take(const v1::PlannerMessage& message) {
    switch (message.message_case()) {
      case v1::PlannerMessage::kCut:
        return TakeCut(message.cut());
      case v1::PlannerMessage::kReportsAcknowledged:
        return shared_.journal.AddAcknowledgement(message.reports_acknowledged().report_number());
      case v1::PlannerMessage::kHold:
        runner_.Hold(message.hold().work_order(), "the fabplanner said so");
        return absl::OkStatus();
      case v1::PlannerMessage::kResume: {
        const absl::Status resumed = runner_.Resume(message.resume().work_order());
        if (!resumed.ok()) {
          Log(LogLevel::kWarning, "not everything resumed", {{"error", resumed.ToString()}});
        }
        return absl::OkStatus();
      }
      case v1::PlannerMessage::kClearAlarm: {
        const absl::Status cleared = runner_.ClearAlarm(message.clear_alarm().machine());
        if (!cleared.ok()) {
          Log(LogLevel::kWarning, "an alarm is not cleared", {{"error", cleared.ToString()}});
        }
        return absl::OkStatus();
      }
      case v1::PlannerMessage::MESSAGE_NOT_SET:
        break;
    }
    Log(LogLevel::kWarning, "the fabplanner sent a message this bridge does not know");
    return absl::OkStatus();
  }

  absl::Status TakeCut(const v1::CutCommand& command) {
    const absl::StatusOr<CutOrder> order = CutFromProto(command);
    if (order.ok()) {
      MORTISE_RETURN_IF_ERROR(runner_.Accept(*order));
    } else {
      MORTISE_RETURN_IF_ERROR(shared_.journal.AddRejection(
          {command.work_order(), command.machine(), command.sequence()},
          std::string(order.status().message())));
    }
    v1::BridgeMessage message;
    message.mutable_command_accepted()->set_work_order(command.work_order());
    message.mutable_command_accepted()->set_machine(command.machine());
    message.mutable_command_accepted()->set_sequence(command.sequence());
    const std::lock_guard lock(shared_.mutex);
    accepted_.push_back(std::move(message));
    ++shared_.changes;
    shared_.changed.notify_all();
    return absl::OkStatus();
  }

  // Writes what there is to tell, and the machines' states at least every period.
  void WriteAll(std::stop_token stop) {
    long seen = -1;
    while (true) {
      std::deque<v1::BridgeMessage> messages;
      {
        std::unique_lock lock(shared_.mutex);
        shared_.changed.wait_for(lock, stop, Seconds(shared_.options.state_period),
                                 [&] { return ended_ || shared_.changes != seen; });
        if (ended_ || stop.stop_requested()) return;
        seen = shared_.changes;
        messages = std::exchange(accepted_, {});
      }
      AddReports(messages);
      messages.push_back(States());
      for (const v1::BridgeMessage& message : messages) {
        if (!stream_->Write(message)) return;
      }
    }
  }

  // A cut's acceptance is queued before its report can be, and reports go out in order.
  void AddReports(std::deque<v1::BridgeMessage>& messages) {
    for (const CutReport& report : shared_.journal.UnacknowledgedReports()) {
      if (report.number <= last_report_) continue;
      last_report_ = report.number;
      *messages.emplace_back().mutable_cut_report() = ReportToProto(report);
    }
  }

  v1::BridgeMessage States() {
    v1::BridgeMessage message;
    for (const MachineView& view : runner_.Machines()) {
      *message.mutable_machine_states()->add_machines() = MachineToProto(view);
    }
    return message;
  }

  Shared& shared_;
  WorkOrderRunner& runner_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::BridgeMessage, v1::PlannerMessage>> stream_;
  absl::Status failure_;                    // of the reading thread, read after it ended
  bool ended_ = false;                      // guarded by shared_.mutex
  std::deque<v1::BridgeMessage> accepted_;  // guarded by shared_.mutex
  std::int64_t last_report_ = 0;            // told on this line
};

BridgeClient::BridgeClient(std::unique_ptr<Shared> shared) : shared_(std::move(shared)) {}

BridgeClient::~BridgeClient() = default;

absl::StatusOr<std::unique_ptr<BridgeClient>> BridgeClient::Create(const Options& options,
                                                                   Journal& journal) {
  auto shared = std::make_unique<Shared>(options, journal);
  MORTISE_ASSIGN_OR_RETURN(shared->channel, rpc::MakeChannel(options.gateway, options.security));
  return std::unique_ptr<BridgeClient>(new BridgeClient(std::move(shared)));
}

void BridgeClient::NotifyChange() {
  const std::lock_guard lock(shared_->mutex);
  ++shared_->changes;
  shared_->changed.notify_all();
}

// Holds all cuts once whenever the line has been down for too long.
void BridgeClient::WatchLine(WorkOrderRunner& runner, std::stop_token stop) {
  const auto attached = [this] { return shared_->attached; };
  std::unique_lock lock(shared_->mutex);
  while (!stop.stop_requested()) {
    const auto deadline = shared_->detached_since + Seconds(shared_->options.line_lost_after);
    if (!shared_->attached && !shared_->changed.wait_until(lock, stop, deadline, attached) &&
        !stop.stop_requested()) {
      lock.unlock();
      runner.Hold("", "the line to the fabplanner is lost");
      lock.lock();
      shared_->changed.wait(lock, stop, attached);
    }
    shared_->changed.wait(lock, stop, [this] { return !shared_->attached; });
  }
}

void BridgeClient::Run(WorkOrderRunner& runner, std::stop_token stop) {
  // Apart from dialling, which may block for long on a network that swallows packets.
  std::jthread watching([&](std::stop_token ended) { WatchLine(runner, ended); });
  std::minstd_rand random(std::random_device{}());
  double delay = shared_->options.first_delay;
  while (!stop.stop_requested()) {
    const auto start = steady_clock::now();
    const absl::Status status = Line(*shared_, runner).Run(stop);
    if (stop.stop_requested()) return;
    Log(LogLevel::kWarning, "the line to the fabplanner is down", {{"error", status.ToString()}});
    // A line that stood for a while begins anew; the jitter keeps many bridges from dialling at
    // once.
    const bool stood = steady_clock::now() - start > Seconds(shared_->options.longest_delay);
    if (stood) delay = shared_->options.first_delay;
    const double jitter = std::uniform_real_distribution<double>(0.5, 1.0)(random);
    std::unique_lock lock(shared_->mutex);
    shared_->changed.wait_for(lock, stop, Seconds(delay * jitter), [] { return false; });
    delay = std::min(2.0 * delay, shared_->options.longest_delay);
  }
}

}  // namespace mortise::hwbridge
