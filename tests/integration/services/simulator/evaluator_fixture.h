// Evaluators that customers register, and what their workers do.
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/rpc/status_mapping.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/simulator_process.h"

namespace mortise::simulator {

// Two parameters; of the three metrics one offers its gradient.
inline constexpr char kBeam[] = R"(
  name: 'evaluators/beam' title: 'Beam' version: '1' space {
    parameters { name: 'length' unit: 'm' minimum: 1 maximum: 3 default_value: 2 }
    parameters { name: 'height' unit: 'm' minimum: 0.1 maximum: 0.4 default_value: 0.2 }
    metrics { name: 'mass' unit: 'kg' offers_gradient: true }
    metrics { name: 'deflection' unit: 'm' }
    metrics { name: 'cost' unit: 'EUR' } })";

class EvaluatorTest : public SimulatorProcessTest {
 protected:
  using Results = std::map<int, v1::EvaluationResult>;
  using Service = v1::EvaluatorService::Stub;

  static v1::Evaluator Beam() {
    v1::Evaluator beam;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(kBeam, &beam));
    return beam;
  }

  std::unique_ptr<Service> Evaluators() const {
    return v1::EvaluatorService::NewStub(service_.channel());
  }

  absl::StatusOr<v1::Evaluator> Create(const v1::Evaluator& evaluator) {
    v1::CreateEvaluatorRequest request;
    request.set_request_id("create-" + std::to_string(++requests_));
    *request.mutable_evaluator() = evaluator;
    return testing::Call(*Evaluators(), &Service::CreateEvaluator, request);
  }

  absl::Status Delete(const std::string& name) {
    v1::DeleteEvaluatorRequest request;
    request.set_request_id("delete-" + std::to_string(++requests_));
    request.set_name(name);
    return testing::Call(*Evaluators(), &Service::DeleteEvaluator, request).status();
  }

  static v1::EvaluateBatchRequest Batch(int points, const std::vector<std::string>& metrics,
                                        const std::string& subject = "evaluators/beam") {
    v1::EvaluateBatchRequest request;
    request.set_subject(subject);
    for (const std::string& metric : metrics) request.add_metrics(metric);
    for (int i = 0; i < points; ++i) {
      v1::DesignPoint& point = *request.add_points();
      point.add_parameters(1 + 2.0 * i / points);
      point.add_parameters(0.2);
    }
    return request;
  }

  absl::StatusOr<Results> Evaluate(const v1::EvaluateBatchRequest& request) {
    const auto stub = Evaluators();
    const auto context = Context();
    const auto reader = stub->EvaluateBatch(context.get(), request);
    Results results;
    v1::EvaluationResult result;
    while (reader->Read(&result)) EXPECT_TRUE(results.emplace(result.index(), result).second);
    const grpc::Status status = reader->Finish();
    if (!status.ok()) return rpc::FromGrpc(status);
    return results;
  }

  absl::StatusOr<v1::LeaseTasksResponse> Lease(const std::string& evaluator, int limit = 1,
                                               double lease = 60) {
    v1::LeaseTasksRequest request;
    request.set_evaluator(evaluator);
    request.set_worker("solver");
    request.set_limit(limit);
    request.set_lease_seconds(lease);
    request.set_wait_seconds(50);
    return testing::Call(*Simulator(), &v1::SimulatorService::Stub::LeaseTasks, request);
  }

  v1::Task LeaseOne(double lease = 60) {
    const auto leased = Lease("evaluators/beam", 1, lease);
    EXPECT_TRUE(leased.ok()) << leased.status();
    EXPECT_EQ(leased.ok() ? leased->tasks_size() : 0, 1);
    return leased.ok() && leased->tasks_size() > 0 ? leased->tasks(0) : v1::Task();
  }

  absl::Status Report(const v1::Task& task, const v1::EvaluationResult& result) {
    v1::ReportTaskRequest request;
    request.mutable_task()->set_name(task.name());
    request.mutable_task()->set_attempt(task.attempt());
    *request.mutable_result() = result;
    return testing::Call(*Simulator(), &v1::SimulatorService::Stub::ReportTask, request).status();
  }

  // The metrics asked for, each ten times the length, without units.
  static v1::EvaluationResult Answer(const v1::Task& task) {
    v1::EvaluationResult result;
    for (const std::string& name : task.metrics()) {
      v1::Metric& metric = *result.add_metrics();
      metric.set_name(name);
      metric.set_value(10 * task.point().parameters(0));
    }
    return result;
  }

  static v1::EvaluationResult Error(absl::StatusCode code, const std::string& message) {
    v1::EvaluationResult result;
    result.mutable_error()->set_code(static_cast<int>(code));
    result.mutable_error()->set_message(message);
    return result;
  }

  // What comes of a batch of one point while `work` plays the worker.
  template <typename Work>
  absl::Status OutcomeOf(const v1::EvaluateBatchRequest& request, const Work& work) {
    absl::StatusOr<Results> results = absl::UnknownError("not run");
    std::thread client([&] { results = Evaluate(request); });
    work();
    client.join();
    if (!results.ok()) return results.status();
    return rpc::FromProto(results->at(0).error());
  }

 private:
  int requests_ = 0;
};

}  // namespace mortise::simulator
