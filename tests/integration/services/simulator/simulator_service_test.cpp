// The simulator as processes: batches over workers, analyses with files, faults and bad input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "common/base/digest.h"
#include "common/base/files.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/simulator/simulator_process.h"

namespace mortise::simulator {
namespace {

class SimulatorServiceTest : public SimulatorProcessTest {
 protected:
  // Points between the bounds of the table's parameters, `count` of them, all different.
  v1::EvaluateBatchRequest Batch(int count, const std::vector<std::string>& metrics,
                                 double shift = 0) {
    v1::EvaluateBatchRequest request;
    request.set_subject("templates/table");
    for (const std::string& metric : metrics) request.add_metrics(metric);
    for (int i = 0; i < count; ++i) {
      v1::DesignPoint* point = request.add_points();
      for (const v1::Parameter& parameter : catalog_.table().parameters()) {
        const double share = 0.3 + 0.4 * (i + shift) / count;
        point->add_parameters(parameter.minimum() +
                              share * (parameter.maximum() - parameter.minimum()));
      }
    }
    return request;
  }

  // Evaluates and collects the results by index; each index may come once.
  grpc::Status Evaluate(const v1::EvaluateBatchRequest& request,
                        std::map<int, v1::EvaluationResult>& results) {
    const auto stub = v1::EvaluatorService::NewStub(service_.channel());
    const auto context = Context();
    const auto reader = stub->EvaluateBatch(context.get(), request);
    v1::EvaluationResult result;
    while (reader->Read(&result)) EXPECT_TRUE(results.emplace(result.index(), result).second);
    return reader->Finish();
  }

  std::vector<v1::Task> Lease(const std::string& worker, double lease, double wait) {
    v1::LeaseTasksRequest request;
    request.set_evaluator("simulator");
    request.set_worker(worker);
    request.set_limit(1);
    request.set_lease_seconds(lease);
    request.set_wait_seconds(wait);
    v1::LeaseTasksResponse response;
    const auto context = Context();
    const grpc::Status status = Simulator()->LeaseTasks(context.get(), request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return {response.tasks().begin(), response.tasks().end()};
  }
};

TEST_F(SimulatorServiceTest, DescribesTheDesignSpace) {
  const auto stub = v1::EvaluatorService::NewStub(service_.channel());
  v1::DescribeDesignSpaceRequest request;
  request.set_subject("templates/table");
  v1::DesignSpace space;
  const auto context = Context();
  const grpc::Status status = stub->DescribeDesignSpace(context.get(), request, &space);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(space.revision(), 1);
  EXPECT_EQ(space.parameters_size(), catalog_.table().parameters_size());
  EXPECT_GE(space.metrics_size(), 5);
}

TEST_F(SimulatorServiceTest, WorkersEvaluateABatchOnceAndForAll) {
  const auto first = StartWorker("first");
  const auto second = StartWorker("second");
  const v1::EvaluateBatchRequest request = Batch(4, {"mass", "max_displacement", "compliance"});
  std::map<int, v1::EvaluationResult> results;
  grpc::Status status = Evaluate(request, results);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(results.size(), 4u);
  for (const auto& [index, result] : results) {
    ASSERT_FALSE(result.has_error()) << result.error().message();
    ASSERT_EQ(result.metrics_size(), 3);
    EXPECT_EQ(result.metrics(0).unit(), "kg");
    EXPECT_GT(result.metrics(0).value(), 5);
    EXPECT_LT(result.metrics(0).value(), 100);
    EXPECT_GT(result.metrics(1).value(), 1e-6);
    EXPECT_LT(result.metrics(1).value(), 0.02);
    EXPECT_FALSE(result.cached());
  }
  // Again, from memory; and after kill -9, from the store.
  for (int round = 0; round < 2; ++round) {
    std::map<int, v1::EvaluationResult> again;
    status = Evaluate(request, again);
    ASSERT_TRUE(status.ok()) << status.error_message();
    ASSERT_EQ(again.size(), 4u);
    for (const auto& [index, result] : again) {
      EXPECT_TRUE(result.cached());
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(result.metrics(k).value(), results[index].metrics(k).value());
      }
    }
    if (round == 0) {
      service_.Kill();
      service_.Start();
    }
  }
}

TEST_F(SimulatorServiceTest, GivesExactGradientsOfMass) {
  const auto worker = StartWorker("only");
  v1::EvaluateBatchRequest request = Batch(1, {"mass", "volume"});
  request.set_gradients(true);
  constexpr double kStep = 1e-5;
  v1::DesignPoint shifted = request.points(0);
  shifted.set_parameters(0, shifted.parameters(0) + kStep);
  *request.add_points() = shifted;
  std::map<int, v1::EvaluationResult> results;
  ASSERT_TRUE(Evaluate(request, results).ok());
  ASSERT_EQ(results[0].gradients_size(), 2);
  const double slope = (results[1].metrics(0).value() - results[0].metrics(0).value()) / kStep;
  EXPECT_NEAR(results[0].gradients(0).values(0), slope, 1e-4 * std::abs(slope));
}

// Two workers share the designs on either side.
TEST_F(SimulatorServiceTest, TakesDifferencesWhereNoGradientIsExact) {
  const auto first = StartWorker("first");
  const auto second = StartWorker("second");
  v1::EvaluateBatchRequest request = Batch(1, {"mass", "natural_frequency"});
  request.mutable_mesh()->set_element_size(0.3);
  request.mutable_mesh()->set_linear(true);
  request.set_gradients(true);
  std::map<int, v1::EvaluationResult> exact, all, beside;
  ASSERT_TRUE(Evaluate(request, exact).ok());
  ASSERT_EQ(exact[0].gradients_size(), 1);
  request.set_difference_step(0.02);
  ASSERT_TRUE(Evaluate(request, all).ok());
  ASSERT_EQ(all[0].gradients_size(), 2) << all[0].ShortDebugString();
  EXPECT_FALSE(all[0].gradients(0).by_differences());
  EXPECT_EQ(all[0].gradients(0).values(0), exact[0].gradients(0).values(0));
  const v1::Gradient& frequency = all[0].gradients(1);
  EXPECT_TRUE(frequency.by_differences());
  ASSERT_EQ(frequency.values_size(), catalog_.table().parameters_size());
  // The same by hand, of the first parameter.
  const v1::Parameter& length = catalog_.table().parameters(0);
  const double step = 0.02 * (length.maximum() - length.minimum());
  request.clear_difference_step();
  request.set_gradients(false);
  *request.add_points() = request.points(0);
  request.mutable_points(0)->set_parameters(0, request.points(0).parameters(0) - step);
  request.mutable_points(1)->set_parameters(0, request.points(1).parameters(0) + step);
  ASSERT_TRUE(Evaluate(request, beside).ok());
  const double by_hand = (beside[1].metrics(1).value() - beside[0].metrics(1).value()) / (2 * step);
  EXPECT_NEAR(frequency.values(0), by_hand, 1e-6 * std::abs(by_hand));
  EXPECT_LT(by_hand, 0) << "long tables swing slowly";
}

TEST_F(SimulatorServiceTest, MetricsOfOnesOwnAreDescribedEvaluatedAndCached) {
  const auto worker = StartWorker("only");
  v1::EvaluateBatchRequest request = Batch(2, {"slender", "sag", "mass"});
  request.mutable_mesh()->set_element_size(0.3);
  request.mutable_mesh()->set_linear(true);
  v1::MetricExpression& slender = *request.mutable_metric_definitions()->add_expressions();
  slender.set_name("slender");
  slender.set_unit("1");
  slender.set_expression("length / width");
  v1::MetricExpression& sag = *request.mutable_metric_definitions()->add_expressions();
  sag.set_name("sag");
  sag.set_unit("1");
  sag.set_expression("abs(mean_displacement_z('load')) / length * slender");
  v1::DescribeDesignSpaceRequest describe;
  describe.set_subject("templates/table");
  *describe.mutable_metric_definitions() = request.metric_definitions();
  v1::DesignSpace space;
  const auto context = Context();
  const auto stub = v1::EvaluatorService::NewStub(service_.channel());
  ASSERT_TRUE(stub->DescribeDesignSpace(context.get(), describe, &space).ok());
  EXPECT_EQ(space.metrics(space.metrics_size() - 1).name(), "sag");
  std::map<int, v1::EvaluationResult> first, again, other;
  ASSERT_TRUE(Evaluate(request, first).ok());
  for (const auto& [index, result] : first) {
    ASSERT_FALSE(result.has_error()) << result.error().message();
    const auto& q = request.points(index).parameters();
    EXPECT_NEAR(result.metrics(0).value(), q[0] / q[1], 1e-12);
    EXPECT_GT(result.metrics(1).value(), 1e-7);
    EXPECT_LT(result.metrics(1).value(), 1e-2);
    EXPECT_FALSE(result.cached());
  }
  ASSERT_TRUE(Evaluate(request, again).ok());
  EXPECT_TRUE(again[0].cached());
  request.mutable_metric_definitions()->mutable_expressions(0)->set_expression("width / length");
  ASSERT_TRUE(Evaluate(request, other).ok());
  EXPECT_FALSE(other[0].cached());
  EXPECT_NEAR(other[0].metrics(0).value() * first[0].metrics(0).value(), 1, 1e-12);
  request.mutable_metric_definitions()->mutable_expressions(0)->set_expression("length");
  const grpc::Status refused = Evaluate(request, other);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_NE(refused.error_message().find("metric_definitions.expressions[0].expression: 'slender': "
                                         "has the unit m, not 1"),
            std::string::npos)
      << refused.error_message();
}

TEST_F(SimulatorServiceTest, AnalysesADesignWithFiles) {
  const auto worker = StartWorker("only");
  v1::AnalyzeDesignRequest request;
  request.set_request_id("analysis-1");
  request.set_template_("templates/table");
  request.add_parameters()->set_name("length");
  request.mutable_parameters(0)->set_value(1.6);
  v1::Operation operation;
  auto context = Context();
  grpc::Status status = Simulator()->AnalyzeDesign(context.get(), request, &operation);
  ASSERT_TRUE(status.ok()) << status.error_message();
  const v1::Operation done = Wait(operation.name());
  ASSERT_EQ(done.state(), v1::Operation::SUCCEEDED) << done.error().message();
  v1::Analysis analysis;
  ASSERT_TRUE(done.result().UnpackTo(&analysis));
  EXPECT_EQ(analysis.template_(), "templates/table");
  EXPECT_EQ(analysis.parameters_size(), catalog_.table().parameters_size());
  EXPECT_GT(analysis.elements(), 1000);
  EXPECT_LT(analysis.total_load().z(), 0);
  EXPECT_NEAR(analysis.total_reaction().z(), -analysis.total_load().z(),
              1e-9 * std::abs(analysis.total_load().z()));
  ASSERT_EQ(analysis.artifacts_size(), 2);
  for (const v1::Artifact& artifact : analysis.artifacts()) {
    const std::string bytes = Download(analysis.name(), artifact.file_name());
    EXPECT_EQ(static_cast<int64_t>(bytes.size()), artifact.size());
    EXPECT_EQ(Sha256Hex(bytes), artifact.sha256());
    if (const char* folder = std::getenv("MORTISE_PICTURES")) {
      EXPECT_TRUE(WriteFile(std::filesystem::path(folder) / artifact.file_name(), bytes).ok());
    }
  }
  v1::ListAnalysesResponse list;
  context = Context();
  ASSERT_TRUE(Simulator()->ListAnalyses(context.get(), {}, &list).ok());
  ASSERT_EQ(list.analyses_size(), 1);
  EXPECT_EQ(list.analyses(0).name(), analysis.name());
  // The same request id gives the same operation.
  v1::Operation repeated;
  context = Context();
  ASSERT_TRUE(Simulator()->AnalyzeDesign(context.get(), request, &repeated).ok());
  EXPECT_EQ(repeated.name(), operation.name());
}

TEST_F(SimulatorServiceTest, FindsNaturalFrequencies) {
  const auto worker = StartWorker("only");
  v1::AnalyzeDesignRequest request;
  request.set_request_id("modes-1");
  request.set_template_("templates/table");
  request.mutable_mesh()->set_linear(true);
  request.set_modes(2);
  v1::Operation operation;
  auto context = Context();
  const grpc::Status status = Simulator()->AnalyzeDesign(context.get(), request, &operation);
  ASSERT_TRUE(status.ok()) << status.error_message();
  const v1::Operation done = Wait(operation.name());
  ASSERT_EQ(done.state(), v1::Operation::SUCCEEDED) << done.error().message();
  v1::Analysis analysis;
  ASSERT_TRUE(done.result().UnpackTo(&analysis));
  ASSERT_EQ(analysis.modes_size(), 2);
  EXPECT_GT(analysis.modes(0).frequency(), 1);
  EXPECT_LE(analysis.modes(0).frequency(), analysis.modes(1).frequency());
  const auto metric = std::find_if(analysis.metrics().begin(), analysis.metrics().end(),
                                   [](const auto& m) { return m.name() == "natural_frequency"; });
  ASSERT_NE(metric, analysis.metrics().end());
  EXPECT_EQ(metric->value(), analysis.modes(0).frequency());
  std::vector<std::string> files;
  for (const v1::Artifact& artifact : analysis.artifacts()) files.push_back(artifact.file_name());
  EXPECT_THAT(files, ::testing::UnorderedElementsAre("analysis.vtu", "stress.png", "modes.vtu",
                                                     "mode-1.png", "mode-2.png"));
  for (const int wrong : {-1, 101}) {
    request.set_request_id("modes-wrong");
    request.set_modes(wrong);
    context = Context();
    EXPECT_EQ(Simulator()->AnalyzeDesign(context.get(), request, &operation).error_code(),
              grpc::StatusCode::INVALID_ARGUMENT);
  }
}

TEST_F(SimulatorServiceTest, MetricsOfTheShapeNeedNoMesh) {
  const auto worker = StartWorker("only");
  const std::vector<std::string> names{"mass", "center_of_mass_z", "inertia_zz", "projected_area_x",
                                       "drag", "toppling_margin",  "draught",    "surface_area",
                                       "cost"};
  std::map<int, v1::EvaluationResult> results;
  const grpc::Status status = Evaluate(Batch(3, names), results);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(results.size(), 3u);
  for (const auto& [index, result] : results) {
    ASSERT_FALSE(result.has_error()) << result.error().message();
    ASSERT_EQ(result.metrics_size(), static_cast<int>(names.size()));
    for (int i = 0; i < result.metrics_size(); ++i) {
      EXPECT_EQ(result.metrics(i).name(), names[static_cast<std::size_t>(i)]);
      EXPECT_GT(result.metrics(i).value(), 0) << names[static_cast<std::size_t>(i)];
    }
    EXPECT_EQ(result.metrics(8).unit(), "EUR");
  }
}

TEST_F(SimulatorServiceTest, NoResultIsLostWhenWorkersAndServiceAreKilled) {
  auto worker = StartWorker("doomed");
  std::map<int, v1::EvaluationResult> results;
  const v1::EvaluateBatchRequest request = Batch(6, {"compliance"}, 0.17);
  const auto stub = v1::EvaluatorService::NewStub(service_.channel());
  auto context = Context();
  const auto reader = stub->EvaluateBatch(context.get(), request);
  v1::EvaluationResult result;
  ASSERT_TRUE(reader->Read(&result));  // the worker is at the second task now
  worker->End(SIGKILL);
  service_.Kill();
  while (reader->Read(&result)) {
  }
  EXPECT_FALSE(reader->Finish().ok());
  service_.Start();
  worker = StartWorker("successor");
  const grpc::Status status = Evaluate(request, results);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(results.size(), 6u);
  int cached = 0;
  for (const auto& [index, outcome] : results) {
    EXPECT_FALSE(outcome.has_error()) << outcome.error().message();
    cached += outcome.cached();
  }
  EXPECT_GE(cached, 1);
  EXPECT_EQ(worker->End(SIGTERM), 0);
}

TEST_F(SimulatorServiceTest, ATaskThatEndsItsWorkersIsPutAside) {
  std::map<int, v1::EvaluationResult> results;
  grpc::Status status;
  std::thread client([&] { status = Evaluate(Batch(1, {"compliance"}, 0.4), results); });
  // Three workers take it and vanish; each lease runs out after a second.
  std::string name;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    const std::vector<v1::Task> tasks = Lease("victim-" + std::to_string(attempt), 1, 30);
    ASSERT_EQ(tasks.size(), 1u);
    EXPECT_EQ(tasks[0].attempt(), attempt);
    name = tasks[0].name();
  }
  client.join();
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_TRUE(results[0].has_error());
  EXPECT_EQ(results[0].error().code(), static_cast<int>(grpc::StatusCode::FAILED_PRECONDITION));
  v1::ListTasksRequest request;
  request.set_state(v1::QUARANTINED);
  v1::ListTasksResponse response;
  const auto context = Context();
  ASSERT_TRUE(Simulator()->ListTasks(context.get(), request, &response).ok());
  ASSERT_EQ(response.tasks_size(), 1);
  EXPECT_EQ(response.tasks(0).task().name(), name);
  EXPECT_GT(response.tasks(0).task().point().parameters_size(), 0);
}

TEST_F(SimulatorServiceTest, AStaleAttemptIsRefused) {
  std::map<int, v1::EvaluationResult> results;
  grpc::Status batch;
  std::thread client([&] { batch = Evaluate(Batch(1, {"compliance"}, 0.6), results); });
  const std::vector<v1::Task> slow = Lease("slow", 1, 30);
  ASSERT_EQ(slow.size(), 1u);
  const std::vector<v1::Task> quick = Lease("quick", 60, 30);
  ASSERT_EQ(quick.size(), 1u);
  EXPECT_EQ(quick[0].name(), slow[0].name());
  const auto report = [&](const v1::Task& task, double value) {
    v1::ReportTaskRequest request;
    request.mutable_task()->set_name(task.name());
    request.mutable_task()->set_attempt(task.attempt());
    v1::Metric* metric = request.mutable_result()->add_metrics();
    metric->set_name("compliance");
    metric->set_value(value);
    v1::ReportTaskResponse response;
    const auto context = Context();
    return Simulator()->ReportTask(context.get(), request, &response).error_code();
  };
  v1::RenewLeasesRequest renew;
  renew.add_tasks()->set_name(slow[0].name());
  renew.mutable_tasks(0)->set_attempt(slow[0].attempt());
  v1::RenewLeasesResponse renewed;
  const auto context = Context();
  ASSERT_TRUE(Simulator()->RenewLeases(context.get(), renew, &renewed).ok());
  EXPECT_THAT(renewed.lost(), ::testing::ElementsAre(slow[0].name()));
  EXPECT_EQ(report(slow[0], 1), grpc::StatusCode::ABORTED);
  EXPECT_EQ(report(quick[0], 2), grpc::StatusCode::OK);
  EXPECT_EQ(report(quick[0], 2), grpc::StatusCode::OK);
  client.join();
  ASSERT_TRUE(batch.ok()) << batch.error_message();
  EXPECT_EQ(results[0].metrics(0).value(), 2);
}

TEST_F(SimulatorServiceTest, BadInputIsNamed) {
  const auto code = [this](const v1::EvaluateBatchRequest& request) {
    std::map<int, v1::EvaluationResult> results;
    return Evaluate(request, results).error_code();
  };
  EXPECT_EQ(code({}), grpc::StatusCode::INVALID_ARGUMENT);
  v1::EvaluateBatchRequest request = Batch(1, {"beauty"});
  EXPECT_EQ(code(request), grpc::StatusCode::INVALID_ARGUMENT);
  request = Batch(1, {"mass"});
  request.set_subject("templates/chair");
  EXPECT_EQ(code(request), grpc::StatusCode::NOT_FOUND);
  request.set_subject("../table");
  EXPECT_EQ(code(request), grpc::StatusCode::INVALID_ARGUMENT);
  request = Batch(1, {"mass"});
  request.mutable_points(0)->set_parameters(0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(code(request), grpc::StatusCode::INVALID_ARGUMENT);
  request = Batch(1, {"mass"});
  request.mutable_mesh()->set_element_size(-1);
  EXPECT_EQ(code(request), grpc::StatusCode::INVALID_ARGUMENT);
  // A bad point fails by itself; no worker is needed to say so.
  request = Batch(2, {"mass"});
  request.mutable_points(0)->set_parameters(0, 1e9);
  request.mutable_points(1)->clear_parameters();
  std::map<int, v1::EvaluationResult> results;
  ASSERT_TRUE(Evaluate(request, results).ok());
  EXPECT_THAT(results[0].error().message(), ::testing::HasSubstr("length"));
  EXPECT_EQ(results[1].error().code(), static_cast<int>(grpc::StatusCode::INVALID_ARGUMENT));

  v1::LeaseTasksRequest lease;
  v1::LeaseTasksResponse leased;
  auto context = Context();
  EXPECT_EQ(Simulator()->LeaseTasks(context.get(), lease, &leased).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  v1::ReportTaskRequest report;
  report.mutable_task()->set_name("tasks/unknown");
  report.mutable_task()->set_attempt(1);
  v1::ReportTaskResponse reported;
  context = Context();
  EXPECT_EQ(Simulator()->ReportTask(context.get(), report, &reported).error_code(),
            grpc::StatusCode::NOT_FOUND);
  v1::AnalyzeDesignRequest analyse;
  analyse.set_request_id("bad");
  analyse.set_template_("templates/table");
  analyse.add_parameters()->set_name("wheels");
  v1::Operation operation;
  context = Context();
  EXPECT_EQ(Simulator()->AnalyzeDesign(context.get(), analyse, &operation).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  v1::GetAnalysisRequest get;
  get.set_name("analyses/none");
  v1::Analysis analysis;
  context = Context();
  EXPECT_EQ(Simulator()->GetAnalysis(context.get(), get, &analysis).error_code(),
            grpc::StatusCode::NOT_FOUND);
}

// Elements far too small are refused by the worker, which lives on.
TEST_F(SimulatorServiceTest, AbsurdMeshesAreRefusedAndTheWorkerLives) {
  const auto worker = StartWorker("only");
  v1::EvaluateBatchRequest request = Batch(1, {"compliance"});
  request.mutable_mesh()->set_element_size(1e-5);
  std::map<int, v1::EvaluationResult> results;
  ASSERT_TRUE(Evaluate(request, results).ok());
  EXPECT_EQ(results[0].error().code(), static_cast<int>(grpc::StatusCode::RESOURCE_EXHAUSTED));
  results.clear();
  ASSERT_TRUE(Evaluate(Batch(1, {"mass"}), results).ok());
  EXPECT_FALSE(results[0].has_error()) << results[0].error().message();
}

}  // namespace
}  // namespace mortise::simulator
