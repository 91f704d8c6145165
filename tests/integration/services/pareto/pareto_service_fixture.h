// mortise-pareto as a real process, beside an evaluator in the test.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/identifiers.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/zdt1_evaluator.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::pareto {

class ParetoServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&evaluator_);
    server_ = builder.BuildAndStart();
    pareto_ = std::make_unique<testing::ServiceUnderTest>(
        "mortise-pareto",
        std::vector<std::string>{"--peer=simulator=127.0.0.1:" + std::to_string(port)});
    Connect();
  }

  void TearDown() override {
    evaluator_.Release();
    pareto_.reset();
    server_->Shutdown(std::chrono::system_clock::now());
  }

  void Connect() {
    fronts_ = v1::ParetoService::NewStub(pareto_->channel());
    operations_ = v1::OperationService::NewStub(pareto_->channel());
  }

  static v1::DiscoverFrontRequest Request(int evaluations) {
    v1::DiscoverFrontRequest request;
    request.set_request_id(NewIdentifier());
    auto& specification = *request.mutable_specification();
    specification.set_subject("templates/zdt1");
    specification.set_evaluations(evaluations);
    specification.set_seed(11);
    specification.set_surrogate(v1::DiscoverySpecification::SURROGATE_NEVER);
    specification.add_objectives()->set_metric("mass");
    auto& gain = *specification.add_objectives();
    gain.set_metric("gain");
    gain.set_maximize(true);
    return request;
  }

  v1::Operation Discover(const v1::DiscoverFrontRequest& request) {
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = fronts_->DiscoverFront(&context, request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  v1::Operation Wait(const std::string& name) {
    v1::Operation operation;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(100);
    while (std::chrono::steady_clock::now() < end) {
      grpc::ClientContext context;
      v1::WaitOperationRequest request;
      request.set_name(name);
      request.set_timeout_seconds(20);
      const grpc::Status status = operations_->WaitOperation(&context, request, &operation);
      EXPECT_TRUE(status.ok()) << status.error_message();
      if (!status.ok() || operation.state() >= v1::Operation::SUCCEEDED) break;
    }
    return operation;
  }

  v1::Front FrontOf(const v1::Operation& operation) {
    v1::Front summary, front;
    EXPECT_TRUE(operation.result().UnpackTo(&summary)) << operation.ShortDebugString();
    EXPECT_EQ(summary.points_size(), 0);
    grpc::ClientContext context;
    v1::GetFrontRequest request;
    request.set_name(summary.name());
    const grpc::Status status = fronts_->GetFront(&context, request, &front);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return front;
  }

  std::string Export(const std::string& name, v1::ExportFrontRequest::Format format) {
    grpc::ClientContext context;
    v1::ExportFrontRequest request;
    request.set_name(name);
    request.set_format(format);
    const auto reader = fronts_->ExportFront(&context, request);
    std::string bytes;
    v1::Chunk chunk;
    while (reader->Read(&chunk)) bytes += chunk.data();
    EXPECT_TRUE(reader->Finish().ok());
    return bytes;
  }

  grpc::StatusCode Refusal(const std::function<void(v1::DiscoverySpecification&)>& change) {
    v1::DiscoverFrontRequest request = Request(50);
    change(*request.mutable_specification());
    grpc::ClientContext context;
    v1::Operation operation;
    return fronts_->DiscoverFront(&context, request, &operation).error_code();
  }

  grpc::Status Asked(const v1::PickPointRequest& request, v1::PickPointResponse& response) {
    grpc::ClientContext context;
    return fronts_->PickPoint(&context, request, &response);
  }

  Zdt1Evaluator evaluator_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<testing::ServiceUnderTest> pareto_;
  std::unique_ptr<v1::ParetoService::Stub> fronts_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
};

}  // namespace mortise::pareto
