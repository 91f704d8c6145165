// mortise-interpolator as a real process, beside an evaluator in the test.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/identifiers.h"
#include "mortise/v1/interpolator.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/services/interpolator/function_evaluator.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/support/reserved_port.h"

namespace mortise::interpolator {

class InterpolatorServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    StartEvaluator();
    StartInterpolator({});
  }

  // With these flags beside the usual ones, on a state of its own, or the store of this URL.
  void StartInterpolator(std::vector<std::string> flags, const std::string& store = {}) {
    flags.insert(flags.end(),
                 {"--peer=simulator=" + port_.address(), "--peer=catalog=" + port_.address()});
    interpolator_ = std::make_unique<testing::ServiceUnderTest>("mortise-interpolator",
                                                                std::move(flags), store);
    Connect();
  }

  void TearDown() override {
    evaluator_.Release();
    interpolator_.reset();
    EndEvaluator();
  }

  // At the same address as before, if it was ended.
  void StartEvaluator() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(port_.address(), grpc::InsecureServerCredentials());
    builder.RegisterService(&evaluator_);
    builder.RegisterService(&evaluator_.files());
    builder.RegisterService(&events_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
  }
  void EndEvaluator() {
    if (server_ == nullptr) return;
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
    server_.reset();
  }

  void Connect() {
    maps_ = v1::InterpolatorService::NewStub(interpolator_->channel());
    operations_ = v1::OperationService::NewStub(interpolator_->channel());
  }

  // Of x and y, the two numbers of the evaluator.
  static v1::BuildMapRequest Request(int evaluations) {
    v1::BuildMapRequest request;
    request.set_request_id(NewIdentifier());
    auto& specification = *request.mutable_specification();
    specification.set_subject("evaluators/bowl");
    specification.set_evaluations(evaluations);
    specification.set_seed(11);
    specification.add_metrics()->set_name("mass");
    specification.add_metrics()->set_name("stress");
    return request;
  }

  v1::Operation Build(const v1::BuildMapRequest& request) {
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = maps_->BuildMap(&context, request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  grpc::Status Refused(const std::function<void(v1::MapSpecification&)>& change) {
    v1::BuildMapRequest request = Request(50);
    change(*request.mutable_specification());
    grpc::ClientContext context;
    v1::Operation operation;
    return maps_->BuildMap(&context, request, &operation);
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

  static v1::DesignMap MapOf(const v1::Operation& operation) {
    v1::DesignMap map;
    EXPECT_TRUE(operation.result().UnpackTo(&map)) << operation.ShortDebugString();
    return map;
  }
  v1::DesignMap Built(const v1::BuildMapRequest& request) {
    return MapOf(Wait(Build(request).name()));
  }

  v1::DesignMap Get(const std::string& name, grpc::Status* status = nullptr) {
    grpc::ClientContext context;
    v1::GetMapRequest request;
    request.set_name(name);
    v1::DesignMap map;
    const grpc::Status answered = maps_->GetMap(&context, request, &map);
    if (status != nullptr) {
      *status = answered;
    } else {
      EXPECT_TRUE(answered.ok()) << answered.error_message();
    }
    return map;
  }

  grpc::Status Asked(const v1::EvaluateMapRequest& request, v1::EvaluateMapResponse& response) {
    grpc::ClientContext context;
    return maps_->EvaluateMap(&context, request, &response);
  }
  v1::EvaluateMapResponse Evaluate(const std::string& name, const std::vector<double>& points,
                                   bool gradients = false) {
    v1::EvaluateMapRequest request;
    request.set_name(name);
    request.mutable_points()->Add(points.begin(), points.end());
    request.set_gradients(gradients);
    v1::EvaluateMapResponse response;
    const grpc::Status status = Asked(request, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  v1::Operation Verify(const v1::VerifyMapRequest& request) {
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = maps_->VerifyMap(&context, request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  FunctionEvaluator evaluator_;
  ToldEvents events_;
  const testing::ReservedPort port_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<testing::ServiceUnderTest> interpolator_;
  std::unique_ptr<v1::InterpolatorService::Stub> maps_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
};

}  // namespace mortise::interpolator
