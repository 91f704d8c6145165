// The fabplanner as a process beside a catalog of this test's, and calls of it.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <string>

#include "google/rpc/status.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/services/fabplanner/fake_bridge.h"
#include "tests/integration/services/fabplanner/fake_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::fabplanner {

inline constexpr int kTableCuts = 4 + 8 + 1;  // trims of four boards, crosscuts, the top

class FabPlannerServiceTest : public ::testing::Test {
 protected:
  std::unique_ptr<v1::FabPlannerService::Stub> Planner() {
    return v1::FabPlannerService::NewStub(process_.channel());
  }

  static std::unique_ptr<grpc::ClientContext> Context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    return context;
  }

  static std::string NewRequestId() {
    static std::atomic<int> count = 0;  // several threads of a test may ask
    return "request-" + std::to_string(++count);
  }

  static v1::CreatePlanRequest TableRequest() {
    v1::CreatePlanRequest request;
    request.set_request_id(NewRequestId());
    request.set_template_("templates/table");
    return request;
  }

  v1::Operation Wait(const v1::Operation& started) {
    auto stub = v1::OperationService::NewStub(process_.channel());
    v1::WaitOperationRequest request;
    request.set_name(started.name());
    request.set_timeout_seconds(50);
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = stub->WaitOperation(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  v1::Operation CreatePlan(const v1::CreatePlanRequest& request) {
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = Planner()->CreatePlan(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return Wait(operation);
  }

  v1::Plan PlanTable() {
    const v1::Operation operation = CreatePlan(TableRequest());
    EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
    v1::Plan plan;
    EXPECT_TRUE(operation.result().UnpackTo(&plan));
    return plan;
  }

  v1::Operation Release(const v1::Plan& plan) {
    v1::ReleaseWorkOrderRequest request;
    request.set_request_id(NewRequestId());
    request.set_plan(plan.name());
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = Planner()->ReleaseWorkOrder(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  v1::WorkOrder GetOrder(const std::string& name) {
    v1::GetWorkOrderRequest request;
    request.set_name(name);
    v1::WorkOrder order;
    auto context = Context();
    const grpc::Status status = Planner()->GetWorkOrder(context.get(), request, &order);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return order;
  }

  std::string Download(const v1::Plan& plan, const std::string& file_name, std::string* sha256) {
    v1::DownloadArtifactRequest request;
    request.set_name(plan.name());
    request.set_file_name(file_name);
    auto context = Context();
    auto stream = Planner()->DownloadArtifact(context.get(), request);
    std::string bytes;
    for (v1::Chunk chunk; stream->Read(&chunk);) {
      EXPECT_EQ(chunk.offset(), static_cast<int64_t>(bytes.size()));
      if (chunk.offset() == 0) *sha256 = chunk.sha256();
      bytes += chunk.data();
    }
    const grpc::Status status = stream->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    return bytes;
  }

  // How often each type of event was told of a subject, as soon as `last_type` has been.
  std::map<std::string, int> EventsUntil(const std::string& subject, const std::string& last_type) {
    auto stub = v1::EventService::NewStub(process_.channel());
    v1::FollowEventsRequest request;
    auto context = Context();
    auto stream = stub->FollowEvents(context.get(), request);
    std::map<std::string, int> counts;
    for (v1::Event event; stream->Read(&event);) {
      if (event.subject() == subject) ++counts[event.type()];
      if (event.subject() == subject && event.type() == last_type) break;
    }
    context->TryCancel();
    stream->Finish();
    return counts;
  }

  static void ExpectEachCutOnce(const FakeBridge& bridge) {
    EXPECT_EQ(bridge.parts_cut().size(), kTableCuts);
    for (const auto& [part, times] : bridge.parts_cut()) EXPECT_EQ(times, 1) << part;
    EXPECT_EQ(bridge.contradictions(), 0);
  }

  FakeCatalog catalog_;
  testing::ServiceUnderTest process_{"mortise-fabplanner",
                                     {"--peer=catalog=" + catalog_.address()}};
};

}  // namespace mortise::fabplanner
