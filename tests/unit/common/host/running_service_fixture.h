// A whole service in the test's process, of whose operations each waits to be released.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/host/operation_codec.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "common/rpc/channel.h"
#include "mortise/v1/audit.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {

class RunningServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK(rpc::CreateIdentityKey(folder_.path() / "keys", "gateway"));
    ASSERT_OK(rpc::CreateIdentityKey(folder_.path() / "keys", "probe"));
    gateway_ = *rpc::IdentitySigner::Load(folder_.path() / "keys", "gateway");
    handlers_.begin = [this](const rpc::Call& call, const KeepRequest& request,
                             store::Transaction& transaction) -> absl::StatusOr<v1::Operation> {
      operations::NewOperation wanted = rpc::OperationOf(
          call, "probe.work", "things/" + request.name(), request, request.value());
      if (!keeps_methods_) wanted.method.clear();
      MORTISE_ASSIGN_OR_RETURN(operations::Operation operation,
                               service_->environment().operations->Start(transaction, wanted));
      return rpc::ToProto(operation);
    };
    Start();
  }

  void TearDown() override {
    Release();
    service_.reset();
  }

  rpc::ServiceOptions Options() {
    rpc::ServiceOptions options;
    options.name = "probe";
    options.store = "sqlite:" + (folder_.path() / "probe.db").string();
    options.blobs = folder_.path() / "blobs";
    options.keys = folder_.path() / "keys";
    options.metrics = "127.0.0.1:0";
    options.port_file = folder_.path() / "ports.json";
    return options;
  }

  void Start() {
    auto service = rpc::RunningService::Start(Options(), [this](rpc::ServiceEnvironment& given) {
      given.operations->Register(
          "probe.work", [this](operations::OperationContext& context) { return Work(context); });
      return absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>>(
          std::vector<std::shared_ptr<grpc::Service>>{
              std::make_shared<ProbeAdapter>(given.dispatcher, &handlers_)});
    });
    ASSERT_OK(service);
    service_ = *std::move(service);
    const auto channel = *rpc::MakeChannel(service_->address(), {});
    probe_ = ProbeService::NewStub(channel);
    operations_ = v1::OperationService::NewStub(channel);
    events_ = v1::EventService::NewStub(channel);
    audit_ = v1::AuditService::NewStub(channel);
  }

  // Reports progress, then waits to be released or cancelled.
  absl::StatusOr<std::string> Work(operations::OperationContext& context) {
    context.ReportProgress({.done = 1, .total = 2, .message = "half"});
    if (context.request() == "fail") return InvalidField("value", "was told to fail");
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, context.stop_token(), [this] { return released_; })) {
      return absl::CancelledError("cancelled");
    }
    Kept kept;
    kept.set_value(context.request());
    return rpc::PackResult(kept);
  }

  void Release() {
    std::lock_guard lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }

  rpc::Origin As(rpc::Role role) {
    rpc::Origin origin;
    origin.deadline = absl::Now() + absl::Seconds(30);
    origin.identity = [this, role] { return gateway_->Sign("users/ada", role, "trace-9"); };
    return origin;
  }

  v1::Operation Begin(const std::string& id, const std::string& value) {
    KeepRequest request;
    request.set_request_id(id);
    request.set_name("a");
    request.set_value(value);
    const auto operation =
        rpc::CallUnary(*probe_, &ProbeService::Stub::Begin, request, As(rpc::Role::kOperator));
    EXPECT_OK(operation);
    return operation.ok() ? *operation : v1::Operation();
  }

  absl::StatusOr<v1::Operation> Wait(const std::string& name, std::optional<double> seconds = {}) {
    v1::WaitOperationRequest request;
    request.set_name(name);
    if (seconds) request.set_timeout_seconds(*seconds);
    return rpc::CallUnary(*operations_, &v1::OperationService::Stub::WaitOperation, request,
                          As(rpc::Role::kViewer));
  }

  absl::StatusOr<v1::Operation> Cancel(const std::string& id, const std::string& name,
                                       rpc::Role role = rpc::Role::kOperator) {
    v1::CancelOperationRequest request;
    request.set_request_id(id);
    request.set_name(name);
    return rpc::CallUnary(*operations_, &v1::OperationService::Stub::CancelOperation, request,
                          As(role));
  }

  absl::StatusOr<v1::ListOperationsResponse> List(const v1::ListOperationsRequest& request) {
    return rpc::CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                          As(rpc::Role::kViewer));
  }

  // Events from the first on, until one of `type`.
  std::vector<v1::Event> FollowUntil(const std::string& type,
                                     const v1::FollowEventsRequest& request = {}) {
    auto context = rpc::MakeClientContext(As(rpc::Role::kViewer));
    auto reader = events_->FollowEvents(context.get(), request);
    std::vector<v1::Event> events;
    v1::Event event;
    while (reader->Read(&event)) {
      events.push_back(event);
      if (event.type() == type) break;
    }
    context->TryCancel();
    reader->Finish();
    return events;
  }

  TemporaryFolder folder_;
  ProbeHandlers handlers_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool released_ = false;
  bool keeps_methods_ = true;  // as versions do that keep which method started an operation
  std::unique_ptr<rpc::IdentitySigner> gateway_;
  std::unique_ptr<rpc::RunningService> service_;
  std::unique_ptr<ProbeService::Stub> probe_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
  std::unique_ptr<v1::EventService::Stub> events_;
  std::unique_ptr<v1::AuditService::Stub> audit_;
};

}  // namespace mortise::testing
