// Uploaded meshes through the simulator as processes: every format, files, restarts, bad input.
#include "tests/integration/services/simulator/mesh_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "common/store/blob_folder.h"
#include "google/rpc/status.pb.h"
#include "tests/support/status_assertions.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

std::map<std::string, double> MetricsOf(const v1::CaseResult& result) {
  std::map<std::string, double> metrics;
  for (const v1::Metric& metric : result.metrics()) metrics[metric.name()] = metric.value();
  return metrics;
}

TEST_F(MeshServiceTest, EveryFormatGivesTheBarItsStretch) {
  const auto worker = StartWorker("only");
  const v1::Material spruce = catalog_.Material("materials/spruce");
  const double weight = spruce.density() * 9.81 / (2 * spruce.youngs_modulus());
  const double pull = 1000 / (0.01 * spruce.youngs_modulus());
  std::vector<v1::Analysis> analyses;
  for (const std::string& file : {testing::WriteGmsh22(box_, true),
                                  testing::WriteGmsh41(box_, true), testing::WriteAbaqus(box_)}) {
    const std::string digest = Upload(file);
    v1::AnalyzeMeshRequest request = Bar(digest, digest.substr(0, 20));
    v1::MeshLoadCase& hanging = *request.mutable_case_()->add_load_cases();
    hanging.set_name("weight");
    hanging.mutable_gravity()->set_x(9.81);
    const v1::Analysis analysis = ResultOf(Run(request));
    ASSERT_EQ(analysis.cases_size(), 2);
    EXPECT_EQ(analysis.mesh_file(), digest);
    EXPECT_EQ(analysis.title(), "Bar");
    EXPECT_EQ(analysis.elements(), 60);
    ASSERT_EQ(analysis.metrics_size(), 2);
    EXPECT_NEAR(analysis.metrics(0).value(), 0.01 * spruce.density(), 1e-9);
    // Displacement is largest at the end, whose corner also contracts.
    EXPECT_NEAR(MetricsOf(analysis.cases(0)).at("max_displacement"), pull, 0.01 * pull);
    for (const char* metric :
         {"max_von_mises", "mean_von_mises", "rms_von_mises", "von_mises_p99"}) {
      EXPECT_NEAR(MetricsOf(analysis.cases(0)).at(metric), 1e5, 1) << metric;
    }
    EXPECT_NEAR(MetricsOf(analysis.cases(0)).at("von_mises_integral"), 1e5 * 0.01, 1e-2);
    EXPECT_NEAR(analysis.cases(0).reactions(0).x(), -1000, 1e-6);
    EXPECT_NEAR(analysis.cases(0).parts(0).safety_factor(), spruce.strength() / 1e5,
                1e-3 * spruce.strength() / 1e5);
    EXPECT_NEAR(MetricsOf(analysis.cases(1)).at("max_displacement"), weight, 0.01 * weight);
    analyses.push_back(analysis);
  }
  for (const v1::Analysis& analysis : analyses) {
    for (int c = 0; c < 2; ++c) {
      for (const auto& [name, value] : MetricsOf(analyses[0].cases(c))) {
        // The error of the pull, which the elements hold exactly, is rounding.
        const double tolerance = name == "relative_error" ? 1e-6 : 1e-7 * std::abs(value);
        EXPECT_NEAR(MetricsOf(analysis.cases(c)).at(name), value, tolerance) << name;
      }
    }
  }
  EXPECT_EQ(analyses[2].notes_size(), 1);      // what of the .inp was not used
  ASSERT_EQ(analyses[0].artifacts_size(), 5);  // the case, and two of each load case
  EXPECT_THAT(Download(analyses[0].name(), "case.json"), HasSubstr("youngs_modulus"));
  for (const v1::Artifact& artifact : analyses[0].artifacts()) {
    EXPECT_EQ(Sha256Hex(Download(analyses[0].name(), artifact.file_name())), artifact.sha256());
  }
}

TEST_F(MeshServiceTest, LoadCasesAreSolvedAsOneAsks) {
  const auto worker = StartWorker("only");
  v1::AnalyzeMeshRequest request = Bar(Upload(testing::WriteGmsh41(box_, true)), "direct");
  v1::MeshCase& bar = *request.mutable_case_();
  v1::MeshLoadCase& weight = *bar.add_load_cases();
  weight.set_name("weight");
  weight.mutable_gravity()->set_y(9.81);
  v1::LoadCombination& both = *bar.add_combinations();
  both.set_name("both");
  for (const char* name : {"pull", "weight"}) {
    v1::LoadCombination::Term& term = *both.add_terms();
    term.set_load_case(name);
    term.set_factor(1);
  }
  bar.set_solver(v1::DIRECT);
  const v1::Analysis direct = ResultOf(Run(request));
  request.set_request_id("iterative");
  bar.set_solver(v1::ITERATIVE);
  const v1::Analysis iterative = ResultOf(Run(request));
  for (const v1::Analysis& analysis : {direct, iterative}) {
    ASSERT_EQ(analysis.cases_size(), 3);
    EXPECT_FALSE(analysis.cases(2).has_solver()) << "a sum is not solved";
    for (int c = 0; c < 2; ++c) {
      const v1::SolverReport& solver = analysis.cases(c).solver();
      EXPECT_EQ(solver.iterations() > 0, solver.kind() == v1::ITERATIVE);
      EXPECT_LT(solver.residual(), 1e-8);
      EXPECT_GT(solver.solution_seconds(), 0);
    }
  }
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(direct.cases(c).solver().kind(), v1::DIRECT);
    EXPECT_EQ(iterative.cases(c).solver().kind(), v1::ITERATIVE);
    const double moved = MetricsOf(direct.cases(c)).at("max_displacement");
    EXPECT_NEAR(MetricsOf(iterative.cases(c)).at("max_displacement"), moved, 1e-7 * moved);
  }
}

TEST_F(MeshServiceTest, AnAnalysisOutlivesTheService) {
  const std::string digest = Upload(testing::WriteGmsh41(box_, true));
  v1::Operation operation, cancelled;
  ASSERT_TRUE(Start(Bar(digest, "outlives"), operation).ok());
  ASSERT_TRUE(Start(Bar(digest, "is-cancelled"), cancelled).ok());
  Cancel(cancelled.name());
  service_.Kill();
  service_.Start();
  const auto worker = StartWorker("late");
  EXPECT_EQ(ResultOf(Wait(operation.name())).cases_size(), 1);
  EXPECT_EQ(Analyses(), 1);
  // The same request again is the same operation.
  v1::Operation repeated;
  ASSERT_TRUE(Start(Bar(digest, "outlives"), repeated).ok());
  EXPECT_EQ(repeated.name(), operation.name());
}

TEST_F(MeshServiceTest, WhatIsCancelledIsDroppedByItsWorker) {
  const auto worker = StartWorker("only");
  const std::string digest = Upload(testing::WriteGmsh41(box_, true));
  v1::Operation operation;
  ASSERT_TRUE(Start(WithManyCases(digest, "too-long"), operation).ok());
  ASSERT_TRUE(WaitUntilLeased());
  Cancel(operation.name());
  // The worker, the only one, is free for others, and what it dropped leaves no analysis.
  EXPECT_EQ(ResultOf(Run(Bar(digest, "next"))).cases_size(), 1);
  EXPECT_EQ(Analyses(), 1);
  v1::ListTasksRequest all;
  all.set_evaluator("simulator");
  v1::ListTasksResponse tasks;
  const auto list_context = Context();
  ASSERT_TRUE(Simulator()->ListTasks(list_context.get(), all, &tasks).ok());
  int dropped = 0;
  for (const auto& entry : tasks.tasks()) {
    dropped += entry.task().state() == v1::TASK_CANCELLED ? 1 : 0;
  }
  EXPECT_EQ(dropped, 1) << tasks.ShortDebugString();
  EXPECT_EQ(tasks.tasks_size(), 2);
}

TEST_F(MeshServiceTest, WhatTakesTooLongFails) {
  const auto worker = StartWorker("only", "--time-limit=1");
  const std::string digest = Upload(testing::WriteGmsh41(box_, true));
  const v1::Operation operation = Run(WithManyCases(digest, "too-long"));
  EXPECT_EQ(operation.state(), v1::Operation::FAILED);
  const absl::Status failure = rpc::FromProto(operation.error());
  EXPECT_EQ(failure.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(DetailOf(failure).reason, "TIME_LIMIT");
  EXPECT_EQ(Analyses(), 0);
}

TEST_F(MeshServiceTest, BadInputIsRefusedAndTheWorkerLives) {
  const std::string digest = Upload(testing::WriteGmsh41(box_, true));
  // Before anything is queued:
  const auto refusal = [&](const v1::AnalyzeMeshRequest& request) {
    v1::Operation operation;
    const absl::Status status = rpc::FromGrpc(Start(request, operation));
    EXPECT_FALSE(status.ok());
    return DetailOf(status).field;
  };
  EXPECT_EQ(refusal(Bar(Sha256Hex("nothing"), "bad-1")), "mesh_file");
  EXPECT_EQ(refusal(Bar("no digest", "bad-2")), "mesh_file");
  v1::AnalyzeMeshRequest request = Bar(digest, "bad-3");
  request.mutable_case_()->mutable_load_cases(0)->mutable_forces(0)->mutable_force()->set_x(
      std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(refusal(request), "case.load_cases[0].forces[0].force.x");
  request = Bar(digest, "bad-4");
  request.mutable_case_()->clear_length_unit();
  EXPECT_EQ(refusal(request), "case.length_unit");
  request = Bar(digest, "bad-5");
  request.mutable_case_()->mutable_materials(0)->set_material("materials/cheese");
  v1::Operation none;
  EXPECT_EQ(Start(request, none).error_code(), grpc::StatusCode::NOT_FOUND);

  // By the worker, which has room for no more than this mesh:
  const auto worker = StartWorker("only", "--memory-limit=0.01");
  const auto failure = [&](const v1::AnalyzeMeshRequest& asked) {
    const v1::Operation operation = Run(asked);
    EXPECT_EQ(operation.state(), v1::Operation::FAILED);
    return rpc::FromProto(operation.error());
  };
  request = Bar(digest, "bad-6");
  request.mutable_case_()->mutable_supports(0)->set_groups(0, "X_Min");
  absl::Status status = failure(request);
  EXPECT_EQ(DetailOf(status).field, "case.supports[0].groups[0]");
  EXPECT_THAT(std::string(status.message()), HasSubstr("did you mean 'x_min'?"));
  status = failure(Bar(Upload("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n99"), "bad-7"));
  EXPECT_EQ(DetailOf(status).field, "mesh_file");
  EXPECT_THAT(std::string(status.message()), HasSubstr("line 5"));
  request = Bar(digest, "bad-8");
  request.mutable_case_()->clear_supports();
  EXPECT_EQ(DetailOf(failure(request)).reason, "RIGID_MOTION");
  const std::string large =
      testing::WriteGmsh41(testing::GroupedBox({100, 10, 10}, {80, 6, 6}, false), true);
  EXPECT_EQ(failure(Bar(Upload(large), "bad-9")).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(Analyses(), 0);
  EXPECT_EQ(ResultOf(Run(Bar(digest, "good"))).cases_size(), 1);
  EXPECT_EQ(Analyses(), 1);
}

// Files of 4 kB each, of which the disk holds two.
TEST(FileQuotaTest, LetsTheOldestFilesGoAndSaysWhatWillNeverFit) {
  const TableCatalog catalog;
  const testing::ServiceUnderTest service(
      "mortise-simulator", {"--peer=catalog=" + catalog.address(), "--file-disk-quota=1e-5"});
  const auto stub = v1::SimulatorService::NewStub(service.channel());
  const auto upload = [&stub](char content, std::size_t size) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto writer = stub->UploadBlob(&context, &response);
    v1::Chunk chunk;
    chunk.set_data(std::string(size, content));
    chunk.set_total_size(static_cast<int64_t>(size));
    writer->Write(chunk);
    writer->WritesDone();
    const absl::Status status = rpc::FromGrpc(writer->Finish());
    return status.ok() ? absl::StatusOr<std::string>(response.sha256()) : status;
  };
  const auto download = [&stub](const std::string& sha256) {
    grpc::ClientContext context;
    v1::DownloadBlobRequest request;
    request.set_sha256(sha256);
    const auto reader = stub->DownloadBlob(&context, request);
    v1::Chunk chunk;
    while (reader->Read(&chunk)) {
    }
    return rpc::FromGrpc(reader->Finish());
  };
  EXPECT_EQ(DetailOf(upload('x', 10'001).status()).reason, "FILE_BEYOND_QUOTA");
  const std::string first = upload('a', 4000).value(), second = upload('b', 4000).value();
  // Both may be about to be named.
  const absl::Status full = upload('c', 4000).status();
  EXPECT_TRUE(absl::IsResourceExhausted(full)) << full;
  EXPECT_EQ(DetailOf(full).reason, "FILE_QUOTA");
  const auto blobs = store::BlobFolder::Open(service.folder() / "blobs").value();
  for (const std::string& file : {first, second}) {
    std::filesystem::last_write_time(
        blobs->PathOf(file).value(),
        std::filesystem::file_time_type::clock::now() - std::chrono::minutes(30));
  }
  EXPECT_OK(download(first));
  // What only says how large it will be takes no room from others.
  {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto writer = stub->UploadBlob(&context, &response);
    v1::Chunk announced;
    announced.set_total_size(9000);
    writer->Write(announced);
    writer->WritesDone();
    EXPECT_EQ(DetailOf(rpc::FromGrpc(writer->Finish())).field, "total_size");
    EXPECT_TRUE(blobs->Size(second).ok());
  }
  const absl::StatusOr<std::string> third = upload('c', 4000);
  ASSERT_OK(third);
  EXPECT_OK(download(first));
  EXPECT_OK(download(*third));
  EXPECT_TRUE(absl::IsNotFound(download(second)));
}

}  // namespace
}  // namespace mortise::simulator
