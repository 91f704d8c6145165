// A bridge with machines that cut at once, and a journal that outlives its connections.
#pragma once

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "mortise/v1/fabplanner.grpc.pb.h"

namespace mortise::fabplanner {

// How a bridge behaves while it is connected.
struct BridgeBehaviour {
  int cuts_before_silence = 1 << 30;  // then it accepts, but neither cuts nor reports
  std::string fails_at_part = {};     // the cut of this part fails
  bool ignores_commands = false;      // as if they had been lost on the way
  std::string alarm_of_saw = {};      // that it says hello with; empty for none
};

class FakeBridge {
 public:
  explicit FakeBridge(std::string name) : name_(std::move(name)) {}
  ~FakeBridge() { Disconnect(); }

  // Opens a stream in a thread of its own.
  void Connect(const std::string& address, const BridgeBehaviour& behaviour = {}) {
    Disconnect();
    behaviour_ = behaviour;
    {
      std::lock_guard lock(mutex_);
      context_ = std::make_unique<grpc::ClientContext>();
      finished_ = false;
    }
    // A connection of its own, not one to a service that has died since.
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    auto channel =
        grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
    thread_ = std::thread([this, channel] { Run(channel); });
  }

  // Drops the line without a word.
  void Disconnect() {
    {
      std::lock_guard lock(mutex_);
      if (context_ != nullptr) context_->TryCancel();
    }
    if (thread_.joinable()) thread_.join();
  }

  // Waits until `done(bridge)`; false after 30 s.
  template <class Predicate>
  bool WaitUntil(Predicate done) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(30), [&] { return done(*this); });
  }

  // Tells the state of the saw, and why it is held.
  void TellSaw(const std::string& state, const std::string& held_because, bool alarm = false) {
    v1::BridgeMessage message;
    v1::Machine* saw = message.mutable_machine_states()->add_machines();
    saw->set_name("saw-1");
    saw->set_kind(v1::CHOP_SAW_WITH_FEEDER);
    saw->set_state(state);
    saw->set_held_because(held_because);
    saw->set_alarm(alarm);
    std::lock_guard lock(mutex_);
    if (stream_ != nullptr) stream_->Write(message);
  }

  // For predicates, under the lock.
  int commands_received() const { return commands_received_; }
  int holds() const { return holds_; }
  int resumes() const { return resumes_; }
  // Machines whose alarm it was told to clear, in order.
  const std::vector<std::string>& cleared() const { return cleared_; }
  bool finished() const { return finished_; }
  const grpc::Status& status() const { return status_; }
  int effects() const {
    int count = 0;
    for (const auto& [part, times] : effects_) count += times;
    return count;
  }

  // How often each part was cut. After Disconnect.
  const std::map<std::string, int>& parts_cut() const { return effects_; }
  // Commands by machine and sequence. After Disconnect.
  const std::map<std::pair<std::string, int64_t>, v1::CutCommand>& journal() const {
    return journal_;
  }
  int contradictions() const { return contradictions_; }

 private:
  using Stream = grpc::ClientReaderWriter<v1::BridgeMessage, v1::PlannerMessage>;

  void Run(const std::shared_ptr<grpc::Channel>& channel) {
    auto stub = v1::FabPlannerService::NewStub(channel);
    std::unique_ptr<Stream> stream = stub->AttachBridge(context_.get());
    v1::BridgeMessage hello;
    hello.mutable_hello()->set_bridge(name_);
    AddMachine("saw-1", v1::CHOP_SAW_WITH_FEEDER, hello.mutable_hello());
    hello.mutable_hello()->mutable_machines(0)->set_alarm(!behaviour_.alarm_of_saw.empty());
    hello.mutable_hello()->mutable_machines(0)->set_held_because(behaviour_.alarm_of_saw);
    AddMachine("jigsaw-1", v1::JIGSAW_ROBOT, hello.mutable_hello());
    hello.mutable_hello()->set_next_report_number(static_cast<int64_t>(reports_.size()) + 1);
    stream->Write(hello);
    for (std::size_t i = acknowledged_; i < reports_.size(); ++i) SendReport(*stream, reports_[i]);
    {
      std::lock_guard lock(mutex_);
      stream_ = stream.get();
      CutWaiting(*stream);
      changed_.notify_all();
    }
    v1::PlannerMessage message;
    while (stream->Read(&message)) {
      std::lock_guard lock(mutex_);
      Handle(*stream, message);
      changed_.notify_all();
    }
    {
      std::lock_guard lock(mutex_);
      stream_ = nullptr;
    }
    const grpc::Status status = stream->Finish();
    std::lock_guard lock(mutex_);
    status_ = status;
    finished_ = true;
    changed_.notify_all();
  }

  static void AddMachine(const std::string& name, v1::MachineKind kind,
                         v1::BridgeMessage::Hello* hello) {
    v1::Machine* machine = hello->add_machines();
    machine->set_name(name);
    machine->set_kind(kind);
    machine->set_state("EXECUTE");
  }

  static void SendReport(Stream& stream, const v1::CutReport& report) {
    v1::BridgeMessage message;
    *message.mutable_cut_report() = report;
    stream.Write(message);
  }

  void Handle(Stream& stream, const v1::PlannerMessage& message) {
    if (message.has_hold()) ++holds_;
    if (message.has_resume()) ++resumes_;
    if (message.has_clear_alarm()) cleared_.push_back(message.clear_alarm().machine());
    if (message.has_reports_acknowledged()) {
      acknowledged_ = std::max(
          acknowledged_, static_cast<std::size_t>(message.reports_acknowledged().report_number()));
    }
    if (!message.has_cut()) return;
    ++commands_received_;
    if (behaviour_.ignores_commands) return;
    const v1::CutCommand& command = message.cut();
    const auto [entry, is_new] =
        journal_.emplace(std::pair(command.machine(), command.sequence()), command);
    if (entry->second.part() != command.part()) ++contradictions_;
    v1::BridgeMessage accepted;
    accepted.mutable_command_accepted()->set_work_order(command.work_order());
    accepted.mutable_command_accepted()->set_machine(command.machine());
    accepted.mutable_command_accepted()->set_sequence(command.sequence());
    stream.Write(accepted);
    if (is_new) waiting_.push_back(command);
    CutWaiting(stream);
  }

  void CutWaiting(Stream& stream) {
    while (!waiting_.empty() && effects() < behaviour_.cuts_before_silence) {
      Cut(stream, waiting_.front());
      waiting_.erase(waiting_.begin());
    }
  }

  void Cut(Stream& stream, const v1::CutCommand& command) {
    ++effects_[command.part()];
    v1::CutReport report;
    report.set_work_order(command.work_order());
    report.set_sequence(command.sequence());
    report.set_machine(command.machine());
    const bool fails = command.part() == behaviour_.fails_at_part;
    report.set_outcome(fails ? v1::CUT_FAILED : v1::CUT_DONE);
    if (fails) report.set_message("the blade stalled");
    report.set_seconds(4);
    report.set_report_number(static_cast<int64_t>(reports_.size()) + 1);
    reports_.push_back(report);
    SendReport(stream, report);
  }

  const std::string name_;
  BridgeBehaviour behaviour_;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<grpc::ClientContext> context_;
  Stream* stream_ = nullptr;  // while it is open
  grpc::Status status_;
  bool finished_ = false;
  int commands_received_ = 0;
  int holds_ = 0;
  int resumes_ = 0;
  std::vector<std::string> cleared_;
  int contradictions_ = 0;
  std::size_t acknowledged_ = 0;
  std::map<std::pair<std::string, int64_t>, v1::CutCommand> journal_;
  std::vector<v1::CutCommand> waiting_;
  std::vector<v1::CutReport> reports_;
  std::map<std::string, int> effects_;
};

}  // namespace mortise::fabplanner
