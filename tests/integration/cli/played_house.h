// A gateway that a test plays for commands that wait: its operations go on until they are cancelled
// or the test ends them.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.pb.h"
#include "tests/support/child_process.h"

namespace mortise::cli {

using Json = nlohmann::json;

inline constexpr char kPlanning[] = "operations/fabplanner/p1";
inline constexpr char kCutting[] = "operations/fabplanner/w1";

// Operations that go on until they are cancelled or the test ends them.
class PlayedHouse final : public v1::OperationService::Service,
                          public v1::FabPlannerService::Service {
 public:
  grpc::Status CreatePlan(grpc::ServerContext*, const v1::CreatePlanRequest*,
                          v1::Operation* response) override {
    std::unique_lock lock(mutex_);
    planning_asked_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return answers_; });
    *response = Begin(kPlanning, "CreatePlan", "templates/table");
    return grpc::Status::OK;
  }

  grpc::Status ReleaseWorkOrder(grpc::ServerContext*, const v1::ReleaseWorkOrderRequest*,
                                v1::Operation* response) override {
    const std::lock_guard lock(mutex_);
    *response = Begin(kCutting, "ReleaseWorkOrder", "workOrders/o1");
    return grpc::Status::OK;
  }

  grpc::Status GetOperation(grpc::ServerContext*, const v1::GetOperationRequest* request,
                            v1::Operation* response) override {
    const std::lock_guard lock(mutex_);
    const auto found = operations_.find(request->name());
    if (found == operations_.end()) return {grpc::StatusCode::NOT_FOUND, "no such operation"};
    *response = found->second;
    return grpc::Status::OK;
  }

  grpc::Status ListOperations(grpc::ServerContext*, const v1::ListOperationsRequest* request,
                              v1::ListOperationsResponse* response) override {
    const std::lock_guard lock(mutex_);
    listed_.push_back(*request);
    // Pages of one, as those of large operations are.
    auto next = request->page_token().empty() ? operations_.begin()
                                              : operations_.upper_bound(request->page_token());
    if (next == operations_.end()) return grpc::Status::OK;
    *response->add_operations() = next->second;
    if (std::next(next) != operations_.end()) response->set_next_page_token(next->first);
    return grpc::Status::OK;
  }

  grpc::Status CancelOperation(grpc::ServerContext*, const v1::CancelOperationRequest* request,
                               v1::Operation* response) override {
    const std::lock_guard lock(mutex_);
    if (!operations_.contains(request->name())) {
      return {grpc::StatusCode::NOT_FOUND, "no such operation"};
    }
    cancelled_.push_back(request->name());
    v1::Operation& operation = operations_[request->name()];
    operation.set_cancel_requested(true);
    if (stops_) {
      operation.set_state(v1::Operation::CANCELLED);
      v1::Front front;
      front.set_name("fronts/best");
      operation.mutable_result()->PackFrom(front);
    }
    *response = operation;
    changed_.notify_all();
    return grpc::Status::OK;
  }

  grpc::Status WatchOperation(grpc::ServerContext* context,
                              const v1::WatchOperationRequest* request,
                              grpc::ServerWriter<v1::Operation>* writer) override {
    std::unique_lock lock(mutex_);
    if (!streams_) return TooMany("streams", "TOO_MANY_STREAMS");
    while (!context->IsCancelled()) {
      if (!IsAuthorized(*context)) {
        return {grpc::StatusCode::UNAUTHENTICATED, "the token expired"};
      }
      const v1::Operation now = operations_[request->name()];
      if (!writer->Write(now)) break;
      const bool goes_on =
          now.state() == v1::Operation::RUNNING || now.state() == v1::Operation::PENDING;
      if (!goes_on) break;
      // Looks now and then whether the watcher is still there.
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    return grpc::Status::OK;
  }

  grpc::Status WaitOperation(grpc::ServerContext* context, const v1::WaitOperationRequest* request,
                             v1::Operation* response) override {
    std::unique_lock lock(mutex_);
    if (!waits_) return TooMany("calls", "TOO_MANY_CALLS");
    waited_ = true;
    const auto end = std::chrono::steady_clock::now() +
                     std::chrono::duration<double>(request->timeout_seconds());
    while (!context->IsCancelled() && std::chrono::steady_clock::now() < end &&
           operations_[request->name()].state() == v1::Operation::RUNNING) {
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    *response = operations_[request->name()];
    return grpc::Status::OK;
  }

  grpc::Status ListBridges(grpc::ServerContext*, const v1::ListBridgesRequest*,
                           v1::ListBridgesResponse* response) override {
    auto* const bridge = response->add_bridges();
    bridge->set_name("plant");
    bridge->set_attached(true);
    *bridge->add_machines() = AlarmedSaw();
    v1::Machine* const robot = bridge->add_machines();
    robot->set_name("robot");
    robot->set_state("IDLE");
    return grpc::Status::OK;
  }

  grpc::Status ResumeWorkOrder(grpc::ServerContext*, const v1::ResumeWorkOrderRequest* request,
                               v1::WorkOrder* response) override {
    const std::lock_guard lock(mutex_);
    resumed_.push_back(*request);
    v1::HeldMachine* const held = response->add_held_machines();
    held->set_bridge("plant");
    *held->mutable_machine() = AlarmedSaw();
    return grpc::Status::OK;
  }

  static v1::Machine AlarmedSaw() {
    v1::Machine saw;
    saw.set_name("saw");
    saw.set_state("HELD");
    saw.set_held_because("it jumped");
    saw.set_alarm(true);
    return saw;
  }

  v1::Operation Begin(const std::string& name, const std::string& method,
                      const std::string& subject) {
    v1::Operation& operation = operations_[name];
    operation.set_name(name);
    operation.set_kind("fabplanner.work");
    operation.set_method("mortise.v1.FabPlannerService/" + method);
    operation.set_subject(subject);
    operation.set_creator("users/ada");
    operation.set_state(v1::Operation::RUNNING);
    operation.mutable_progress()->set_done(3);
    operation.mutable_progress()->set_total(10);
    operation.mutable_progress()->set_message("laying out boards");
    operation.mutable_create_time()->set_seconds(1);
    return operation;
  }

  void Add(const std::string& name) {
    const std::lock_guard lock(mutex_);
    Begin(name, "CreatePlan", "templates/table");
  }

  // One that waits for others to end.
  void AddPending(const std::string& name) {
    const std::lock_guard lock(mutex_);
    Begin(name, "CreatePlan", "templates/table");
    operations_[name].set_state(v1::Operation::PENDING);
    operations_[name].clear_progress();
  }

  template <typename Message>
  void Finish(const std::string& name, const Message& result) {
    const std::lock_guard lock(mutex_);
    operations_[name].set_state(v1::Operation::SUCCEEDED);
    operations_[name].mutable_result()->PackFrom(result);
    changed_.notify_all();
  }

  // Whether the start of operations is answered, and whether they stop when cancelled.
  void SetAnswers(bool answers) {
    const std::lock_guard lock(mutex_);
    answers_ = answers;
    changed_.notify_all();
  }
  void SetStops(bool stops) {
    const std::lock_guard lock(mutex_);
    stops_ = stops;
  }

  // Whether operations can be watched, and waited for.
  void SetStreams(bool streams) {
    const std::lock_guard lock(mutex_);
    streams_ = streams;
  }
  void SetWaits(bool waits) {
    const std::lock_guard lock(mutex_);
    waits_ = waits;
  }
  // The token that watching takes; streams of others end.
  void SetToken(const std::string& token) {
    const std::lock_guard lock(mutex_);
    token_ = token;
    changed_.notify_all();
  }
  bool waited() {
    const std::lock_guard lock(mutex_);
    return waited_;
  }
  std::vector<v1::ResumeWorkOrderRequest> resumed() {
    const std::lock_guard lock(mutex_);
    return resumed_;
  }

  void AwaitPlanning() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return planning_asked_; });
  }

  std::vector<std::string> cancelled() {
    const std::lock_guard lock(mutex_);
    return cancelled_;
  }

  std::vector<v1::ListOperationsRequest> listed() {
    const std::lock_guard lock(mutex_);
    return listed_;
  }

 private:
  static grpc::Status TooMany(const std::string& what, const std::string& reason) {
    return rpc::ToGrpc(WithDetail(absl::ResourceExhaustedError("too many " + what), {reason, ""}));
  }

  bool IsAuthorized(const grpc::ServerContext& context) const {
    if (token_.empty()) return true;
    const auto header = context.client_metadata().find("authorization");
    return header != context.client_metadata().end() &&
           header->second == grpc::string_ref("Bearer " + token_);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool answers_ = true;  // guarded by mutex_, as all below
  bool stops_ = true;
  bool streams_ = true;
  bool waits_ = true;
  bool waited_ = false;
  std::string token_;  // empty: none is needed
  std::vector<v1::ResumeWorkOrderRequest> resumed_;
  bool planning_asked_ = false;
  std::map<std::string, v1::Operation> operations_;
  std::vector<std::string> cancelled_;
  std::vector<v1::ListOperationsRequest> listed_;
};

class LongWorkTest : public ::testing::Test {
 protected:
  LongWorkTest() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(static_cast<v1::OperationService::Service*>(&house_));
    builder.RegisterService(static_cast<v1::FabPlannerService::Service*>(&house_));
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~LongWorkTest() override { server_->Shutdown(std::chrono::system_clock::now()); }

  // `mortise` at this gateway.
  std::unique_ptr<testing::ChildProcess> Start(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command = {testing::BuiltProgram("mortise"), "--gateway", address_};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return std::make_unique<testing::ChildProcess>(command);
  }

  // The same with standard output in a file, so that it is told from standard error.
  std::unique_ptr<testing::ChildProcess> StartJson(const std::string& arguments) const {
    const std::string line =
        absl::StrCat("exec ", testing::BuiltProgram("mortise"), " --json --gateway ", address_, " ",
                     arguments, " > ", (folder_.path() / "out").string());
    return std::make_unique<testing::ChildProcess>(std::vector<std::string>{"/bin/sh", "-c", line});
  }

  // What was written there: exactly one document.
  Json Document() const {
    const std::string text = ReadFile(folder_.path() / "out").value_or("");
    const Json document = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    EXPECT_FALSE(document.is_discarded()) << text;
    return document;
  }

  std::string Command() const { return "mortise --gateway " + address_; }

  PlayedHouse house_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  testing::TemporaryFolder folder_;
};

}  // namespace mortise::cli
