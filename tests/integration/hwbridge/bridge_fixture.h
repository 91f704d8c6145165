// The bridge as a process between a fabplanner, played by the test, and the virtual cell.
#pragma once

#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "hwbridge/virtual_cell/machine_memory.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "tests/integration/hwbridge/line_times.h"
#include "tests/support/child_process.h"
#include "tests/support/reserved_port.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {

inline constexpr std::chrono::seconds kPatience(60);
inline constexpr int kCrosscuts = 6;
inline constexpr int kOutlines = 2;

using Stream = grpc::ServerReaderWriter<v1::PlannerMessage, v1::BridgeMessage>;

// As much of a fabplanner as a bridge sees. Its memory survives the stream, like a store.
class Planner : public v1::FabPlannerService::Service {
 public:
  grpc::Status AttachBridge(grpc::ServerContext* context, Stream* stream) override {
    v1::BridgeMessage message;
    if (!stream->Read(&message) || !message.has_hello()) {
      return {grpc::StatusCode::INVALID_ARGUMENT, "hello first"};
    }
    if (!refusal.ok()) return refusal;
    Attach(*context, message.hello(), stream);
    while (stream->Read(&message)) Receive(message);
    const std::lock_guard lock(mutex_);
    if (stream_ == stream) stream_ = nullptr;
    changed_.notify_all();
    return grpc::Status::OK;
  }

  // Gives a cut; it is given again on each new stream until it is accepted.
  void Give(v1::CutCommand command) {
    const std::lock_guard lock(mutex_);
    v1::PlannerMessage message;
    *message.mutable_cut() = command;
    const auto key = std::pair(command.machine(), command.sequence());
    unaccepted_[key] = std::move(command);
    Send(message);
  }

  void Resume() {
    const std::lock_guard lock(mutex_);
    v1::PlannerMessage message;
    message.mutable_resume()->set_work_order("workOrders/a");
    Send(message);
  }

  void Hold() {
    const std::lock_guard lock(mutex_);
    v1::PlannerMessage message;
    message.mutable_hold()->set_work_order("workOrders/a");
    Send(message);
  }

  void ClearAlarm(const std::string& machine) {
    const std::lock_guard lock(mutex_);
    v1::PlannerMessage message;
    message.mutable_clear_alarm()->set_machine(machine);
    Send(message);
  }

  // Waits until `done` holds of what is known. Resumes held machines meanwhile if told to.
  bool Await(const std::function<bool(const Planner&)>& done, bool resume = false) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::unique_lock lock(mutex_);
    while (!done(*this)) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      if (resume && stream_ != nullptr && AnyHalted()) {
        v1::PlannerMessage message;
        message.mutable_resume();
        Send(message);
      }
      changed_.wait_for(lock, std::chrono::milliseconds(100));
    }
    return true;
  }

  // Known to this planner; read within Await.
  std::map<std::int64_t, v1::CutReport> reports;  // by number
  std::map<std::string, std::string> states;      // of machines, by name
  std::map<std::string, std::string> held;        // why machines are held, by name
  std::map<std::string, bool> alarms;             // whether by the alarm, by name
  std::vector<v1::BridgeMessage::Hello> hellos;
  std::set<std::pair<std::string, std::int64_t>> accepted;
  std::string authorization;
  int repeated_reports = 0;
  bool acknowledge = true;
  grpc::Status refusal;  // of every stream; set before the bridge starts

 private:
  void Attach(const grpc::ServerContext& context, const v1::BridgeMessage::Hello& hello,
              Stream* stream) {
    const std::lock_guard lock(mutex_);
    stream_ = stream;
    hellos.push_back(hello);
    NoteStates(hello.machines());
    const auto header = context.client_metadata().find("authorization");
    if (header != context.client_metadata().end()) {
      authorization = std::string(header->second.data(), header->second.size());
    }
    Acknowledge();
    for (const auto& [key, command] : unaccepted_) {
      v1::PlannerMessage message;
      *message.mutable_cut() = command;
      Send(message);
    }
    changed_.notify_all();
  }

  void Receive(const v1::BridgeMessage& message) {
    const std::lock_guard lock(mutex_);
    if (message.has_machine_states()) NoteStates(message.machine_states().machines());
    if (message.has_command_accepted()) {
      const auto key =
          std::pair(message.command_accepted().machine(), message.command_accepted().sequence());
      unaccepted_.erase(key);
      accepted.insert(key);
    }
    if (message.has_cut_report()) {
      const v1::CutReport& report = message.cut_report();
      if (!reports.emplace(report.report_number(), report).second) ++repeated_reports;
      if (acknowledge) Acknowledge();
    }
    changed_.notify_all();
  }

  template <class Machines>
  void NoteStates(const Machines& machines) {
    for (const v1::Machine& machine : machines) {
      states[machine.name()] = machine.state();
      held[machine.name()] = machine.held_because();
      alarms[machine.name()] = machine.alarm();
    }
  }

  bool AnyHalted() const {
    for (const auto& [name, state] : states) {
      if (state == "HELD" || state == "ABORTED" || state == "STOPPED") return true;
    }
    return false;
  }

  void Acknowledge() {
    v1::PlannerMessage message;
    message.mutable_reports_acknowledged()->set_report_number(
        acknowledge ? static_cast<std::int64_t>(reports.size()) : 0);
    Send(message);
  }

  void Send(const v1::PlannerMessage& message) {
    if (stream_ != nullptr) stream_->Write(message);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Stream* stream_ = nullptr;
  std::map<std::pair<std::string, std::int64_t>, v1::CutCommand> unaccepted_;
};

inline v1::CutCommand Crosscut(int sequence) {
  v1::CutCommand command;
  command.set_work_order("workOrders/a");
  command.set_machine("saw");
  command.set_sequence(sequence);
  command.set_part(absl::StrCat("leg-", sequence));
  command.mutable_crosscut()->set_stock("board-1");
  command.mutable_crosscut()->set_position(0.3 * sequence);
  command.mutable_crosscut()->set_length(0.297);
  return command;
}

inline v1::CutCommand Outline(int sequence) {
  v1::CutCommand command;
  command.set_work_order("workOrders/a");
  command.set_machine("robot");
  command.set_sequence(sequence);
  command.set_part(absl::StrCat("seat-", sequence));
  command.mutable_outline()->set_stock("sheet-1");
  for (const auto& [u, v] : {std::pair(0.0, 0.0), {0.3, 0.0}, {0.3, 0.2}, {0.0, 0.2}}) {
    v1::Vector2* point = command.mutable_outline()->add_outline();
    point->set_u(u);
    point->set_v(v);
  }
  return command;
}

class BridgeProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    StartCell();
    StartPlanner();
  }

  void TearDown() override {
    bridge_.reset();
    if (server_) server_->Shutdown(std::chrono::system_clock::now());
  }

  void StartCell() {
    cell_ = std::make_unique<testing::ServiceProcess>(
        testing::BuiltProgram("mortise-virtual-cell"),
        std::vector<std::string>{"--port", cell_port_.port(), "--state",
                                 (folder_.path() / "cell").string(), "--journal",
                                 cut_record_.string(), "--heartbeat-timeout",
                                 absl::StrCat(line_.heartbeat_timeout), "--time-scale", "40"},
        folder_.path() / "port");
  }

  // Deaths are to be noticed at once. Whoever calls this resumes what a busy computer may hold too.
  void NoticeDeathsSoon() {
    line_ = kHastyLine;
    cell_.reset();
    StartCell();
  }

  void StartPlanner() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort(planner_port_.address(), grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&planner_);
    server_ = builder.BuildAndStart();
    ASSERT_TRUE(server_);
    ASSERT_NE(port, 0);
  }

  void StopPlanner() {
    server_->Shutdown(std::chrono::system_clock::now());
    server_.reset();
  }

  void StartBridge(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {testing::BuiltProgram("mortise-hwbridge"),
                                          "--bridge",
                                          "plant",
                                          "--gateway",
                                          planner_port_.address(),
                                          "--machine",
                                          absl::StrCat("saw=chop-saw@", cell_port_.address(), "/1"),
                                          "--machine",
                                          absl::StrCat("robot=jigsaw@", cell_port_.address(), "/2"),
                                          "--journal",
                                          (folder_.path() / "journal").string(),
                                          "--scan-period",
                                          "0.005",
                                          "--answer-timeout",
                                          absl::StrCat(line_.answer_timeout),
                                          "--machine-lost-after",
                                          absl::StrCat(line_.lost_after)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    bridge_ = std::make_unique<testing::ChildProcess>(arguments);
  }

  void GiveAll() {
    for (int i = 1; i <= kCrosscuts; ++i) planner_.Give(Crosscut(i));
    for (int i = 1; i <= kOutlines; ++i) planner_.Give(Outline(i));
  }

  static bool AllReported(const Planner& planner) {
    return planner.reports.size() == kCrosscuts + kOutlines;
  }

  void ExpectEachCutOnce() {
    std::map<std::string, int> counts;
    const auto cuts = ReadCutRecord(cut_record_);
    ASSERT_TRUE(cuts.ok()) << cuts.status();
    for (const Cut& cut : *cuts) ++counts[cut.part];
    EXPECT_EQ(cuts->size(), static_cast<std::size_t>(kCrosscuts + kOutlines));
    for (int i = 1; i <= kCrosscuts; ++i) EXPECT_EQ(counts[absl::StrCat("leg-", i)], 1) << i;
    for (int i = 1; i <= kOutlines; ++i) EXPECT_EQ(counts[absl::StrCat("seat-", i)], 1) << i;
    planner_.Await([](const Planner& planner) {
      for (const auto& [number, report] : planner.reports) {
        EXPECT_EQ(report.outcome(), v1::CUT_DONE) << report.message();
        EXPECT_GT(report.seconds(), 0.0);
      }
      return true;
    });
  }

  LineTimes line_ = kPatientLine;
  TemporaryFolder folder_;
  std::filesystem::path cut_record_ = folder_.path() / "cuts";
  const testing::ReservedPort cell_port_;
  const testing::ReservedPort planner_port_;
  Planner planner_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<testing::ChildProcess> cell_;
  std::unique_ptr<testing::ChildProcess> bridge_;
};

}  // namespace mortise::hwbridge
