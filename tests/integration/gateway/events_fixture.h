// A gateway in front of a real service, which tells events and runs operations, for tests.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "common/rpc/channel.h"
#include "common/store/store.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/gateway/gateway_fixture.h"
#include "tests/support/reserved_port.h"

namespace mortise::gateway {

// A gateway in front of a real catalog process: store, outbox, bus, operations.
class EventsTest : public GatewayTest {
 protected:
  void SetUp() override {
    gateway_options_ = Options();
    gateway_options_.services = {{"catalog", service_port_.address()}};
    gateway_options_.webhooks.first_pause = absl::Milliseconds(10);
    gateway_options_.webhooks.longest_pause = absl::Milliseconds(50);
    gateway_options_.webhooks.max_tries = 3;
    gateway_options_.webhooks.client.allow_loopback = true;
    StartGateway(gateway_options_);
    StartService();
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
    WaitUntilKnown();
  }

  void StartService() {
    rpc::ServiceOptions options;
    options.name = "catalog";
    options.listen = service_port_.address();
    options.store = "sqlite:" + (folder_.path() / "catalog.db").string();
    options.blobs = folder_.path() / "blobs";
    options.insecure_development = true;
    options.bus_publish = gateway_->addresses().bus_publish;
    auto service = rpc::RunningService::Start(
        options,
        [this](rpc::ServiceEnvironment& environment)
            -> absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> {
          environment.operations->Register(
              "catalog.wait",
              [this](operations::OperationContext& context) -> absl::StatusOr<std::string> {
                context.ReportProgress({.done = 1, .total = 2, .message = "half"});
                std::unique_lock lock(mutex_);
                if (!changed_.wait(lock, context.stop_token(), [this] { return finish_; })) {
                  return absl::CancelledError();
                }
                return std::string();
              });
          return std::vector<std::shared_ptr<grpc::Service>>();
        });
    ASSERT_TRUE(service.ok()) << service.status();
    service_ = *std::move(service);
  }

  // The gateway notices the service within moments; until then it says UNAVAILABLE.
  void WaitUntilKnown() {
    const auto stub = v1::EventService::NewStub(channel_);
    v1::ReadEventsRequest request;
    request.set_stream("catalog");
    const auto events = rpc::CallUnary(*stub, &v1::EventService::Stub::ReadEvents, request, {});
    ASSERT_TRUE(events.ok()) << events.status();
  }

  // Waits until the gateway has seen so many events.
  void WaitUntilSeen(int64_t latest) {
    const auto stub = v1::EventService::NewStub(channel_);
    const absl::Status seen = rpc::CallWithRetry({}, {}, [&](grpc::ClientContext* context) {
      v1::ListStreamsResponse streams;
      const grpc::Status status = stub->ListStreams(context, {}, &streams);
      if (!status.ok() || streams.streams(0).latest_number() >= latest) return status;
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
    });
    ASSERT_TRUE(seen.ok()) << seen;
  }

  void Tell(const std::string& type, const std::string& subject) {
    const absl::Status status =
        service_->environment().store->Transact([&](store::Transaction& transaction) {
          return transaction.AppendEvent(
              {.type = type, .subject = subject, .payload = R"({"a":1})", .trace_id = "t"});
        });
    ASSERT_TRUE(status.ok()) << status;
  }

  std::string StartOperation() {
    std::string name;
    const absl::Status status = service_->environment().store->Transact(
        [&](store::Transaction& transaction) -> absl::Status {
          auto operation = service_->environment().operations->Start(
              transaction,
              {.kind = "catalog.wait", .subject = "templates/x", .creator = "users/ada"});
          if (!operation.ok()) return operation.status();
          name = operation->name;
          return absl::OkStatus();
        });
    EXPECT_TRUE(status.ok()) << status;
    return name;
  }

  void FinishOperations() {
    std::lock_guard lock(mutex_);
    finish_ = true;
    changed_.notify_all();
  }

  const mortise::testing::ReservedPort service_port_;
  GatewayOptions gateway_options_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool finish_ = false;  // guarded by mutex_
  std::unique_ptr<rpc::RunningService> service_;
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace mortise::gateway
