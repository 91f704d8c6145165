// Designs analysed as customers do: by catalog, simulator and a worker as processes.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::simulator {

// Catalog with the collection, simulator and a worker.
class AnalysedDesignTest : public ::testing::Test {
 protected:
  // With linear elements, and whatever else is asked for.
  absl::StatusOr<v1::Analysis> Analyze(const std::string& name, double element_size,
                                       const v1::AnalyzeDesignRequest& besides = {}) {
    v1::AnalyzeDesignRequest request = besides;
    request.set_request_id("analysis-" + name);
    request.set_template_(name);
    request.mutable_mesh()->set_linear(true);
    request.mutable_mesh()->set_element_size(element_size);
    const auto simulator = v1::SimulatorService::NewStub(service_.channel());
    MORTISE_ASSIGN_OR_RETURN(
        const v1::Operation started,
        testing::Call(*simulator, &v1::SimulatorService::Stub::AnalyzeDesign, request));
    const auto operations = v1::OperationService::NewStub(service_.channel());
    v1::WaitOperationRequest wait;
    wait.set_name(started.name());
    wait.set_timeout_seconds(60);
    v1::Operation done = started;
    for (int round = 0; round < 4 && done.state() != v1::Operation::SUCCEEDED; ++round) {
      MORTISE_ASSIGN_OR_RETURN(
          done, testing::Call(*operations, &v1::OperationService::Stub::WaitOperation, wait));
      if (done.has_error()) return absl::InternalError(done.error().message());
    }
    v1::Analysis analysis;
    if (!done.result().UnpackTo(&analysis)) return absl::InternalError(done.ShortDebugString());
    return analysis;
  }

  std::string Download(const v1::Analysis& analysis, const std::string& file) {
    v1::DownloadArtifactRequest request;
    request.set_name(analysis.name());
    request.set_file_name(file);
    const auto simulator = v1::SimulatorService::NewStub(service_.channel());
    grpc::ClientContext context;
    const auto reader = simulator->DownloadArtifact(&context, request);
    std::string bytes;
    for (v1::Chunk chunk; reader->Read(&chunk);) bytes += chunk.data();
    EXPECT_TRUE(reader->Finish().ok());
    if (const char* folder = std::getenv("MORTISE_PICTURES")) {
      EXPECT_TRUE(WriteFile(std::filesystem::path(folder) / file, bytes).ok());
    }
    return bytes;
  }

  // The results of designs of a template, each with this share of its range in each parameter.
  std::vector<v1::EvaluationResult> Evaluate(const std::string& subject,
                                             const std::vector<std::string>& metrics,
                                             const std::vector<double>& shares,
                                             const v1::EvaluateBatchRequest& besides = {}) {
    const auto evaluator = v1::EvaluatorService::NewStub(service_.channel());
    v1::DescribeDesignSpaceRequest asked;
    asked.set_subject(subject);
    const auto space =
        testing::Call(*evaluator, &v1::EvaluatorService::Stub::DescribeDesignSpace, asked);
    EXPECT_TRUE(space.ok()) << space.status();
    v1::EvaluateBatchRequest request = besides;
    request.set_subject(subject);
    request.mutable_mesh()->set_linear(true);
    request.mutable_mesh()->set_element_size(0.02);
    *request.mutable_metrics() = {metrics.begin(), metrics.end()};
    for (const double share : shares) {
      v1::DesignPoint& point = *request.add_points();
      for (const auto& parameter : space->parameters()) {
        point.add_parameters(parameter.minimum() +
                             share * (parameter.maximum() - parameter.minimum()));
      }
    }
    grpc::ClientContext context;
    const auto reader = evaluator->EvaluateBatch(&context, request);
    std::vector<v1::EvaluationResult> results(shares.size());
    for (v1::EvaluationResult result; reader->Read(&result);) results[result.index()] = result;
    EXPECT_TRUE(reader->Finish().ok());
    return results;
  }

  static std::vector<std::string> FilesOf(const v1::Analysis& analysis) {
    std::vector<std::string> files;
    for (const v1::Artifact& artifact : analysis.artifacts()) files.push_back(artifact.file_name());
    return files;
  }

  template <typename Message>
  static std::map<std::string, double> MetricsOf(const Message& message) {
    std::map<std::string, double> metrics;
    for (const v1::Metric& metric : message.metrics()) metrics[metric.name()] = metric.value();
    return metrics;
  }

  // Of a worker, behind what starts it, if anything.
  std::vector<std::string> WorkerCommand(std::vector<std::string> command = {}) const {
    command.insert(command.end(),
                   {testing::BuiltProgram("mortise-simulator"), "--worker", "--worker-name=only",
                    "--insecure-development", "--peer=simulator=" + service_.address(),
                    "--peer=catalog=" + catalog_process_.address()});
    return command;
  }

  testing::FilledCatalog catalog_process_;
  testing::ServiceUnderTest service_{"mortise-simulator",
                                     {"--peer=catalog=" + catalog_process_.address()}};
  std::unique_ptr<testing::ChildProcess> worker_ =
      std::make_unique<testing::ChildProcess>(WorkerCommand());
  std::unique_ptr<v1::CatalogService::Stub> catalog_ =
      v1::CatalogService::NewStub(catalog_process_.channel());
};

}  // namespace mortise::simulator
