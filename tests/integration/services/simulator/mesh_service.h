// What tests of uploaded meshes have in common: a bar to analyse, and how its analysis is asked
// for.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "tests/integration/services/simulator/simulator_process.h"
#include "tests/support/mesh_files.h"

namespace mortise::simulator {

class MeshServiceTest : public SimulatorProcessTest {
 protected:
  std::unique_ptr<testing::ChildProcess> StartWorker(
      const std::string& name, const std::string& limit = "--memory-limit=2") const {
    return SimulatorProcessTest::StartWorker(name, {"--solver-threads=2", limit});
  }

  std::string Upload(const std::string& bytes) {
    const auto context = Context();
    v1::UploadBlobResponse response;
    const auto stub = Simulator();
    const auto writer = stub->UploadBlob(context.get(), &response);
    v1::Chunk chunk;
    chunk.set_data(bytes);
    chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    writer->Write(chunk);
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(response.sha256(), Sha256Hex(bytes));
    return response.sha256();
  }

  // A bar of spruce, held at one end so that it may contract, and pulled.
  static v1::AnalyzeMeshRequest Bar(const std::string& mesh_file, const std::string& request_id) {
    v1::AnalyzeMeshRequest request;
    request.set_request_id(request_id);
    request.set_mesh_file(mesh_file);
    v1::MeshCase& bar = *request.mutable_case_();
    bar.set_title("Bar");
    bar.set_length_unit("cm");
    bar.add_materials()->set_material("materials/spruce");
    for (const char* face : {"x_min", "y_min", "z_min"}) {
      v1::MeshSupport& support = *bar.add_supports();
      support.add_groups(face);
      support.set_symmetric(true);
    }
    v1::MeshLoadCase& pull = *bar.add_load_cases();
    pull.set_name("pull");
    v1::GroupForce& force = *pull.add_forces();
    force.add_groups("x_max");
    force.mutable_force()->set_x(1000);
    return request;
  }

  // The bar pulled fifty times and drawn each time: half a minute of work.
  static v1::AnalyzeMeshRequest WithManyCases(const std::string& mesh_file,
                                              const std::string& request_id) {
    v1::AnalyzeMeshRequest request = Bar(mesh_file, request_id);
    v1::MeshCase& bar = *request.mutable_case_();
    for (int i = 1; i < 50; ++i) {
      v1::MeshLoadCase& again = *bar.add_load_cases();
      again = bar.load_cases(0);
      again.set_name(absl::StrCat("pull ", i));
    }
    return request;
  }

  void Cancel(const std::string& operation) {
    v1::CancelOperationRequest cancel;
    cancel.set_name(operation);
    cancel.set_request_id(absl::StrCat("cancel-", operation.substr(operation.find('/') + 1)));
    v1::Operation answer;
    const auto context = Context();
    const auto operations = v1::OperationService::NewStub(service_.channel());
    EXPECT_TRUE(operations->CancelOperation(context.get(), cancel, &answer).ok());
    EXPECT_EQ(Wait(operation).state(), v1::Operation::CANCELLED);
  }

  // Asks until a worker has a task; false after a minute.
  bool WaitUntilLeased() {
    v1::GetQueueStatusRequest asked;
    asked.set_evaluator("simulator");
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (std::chrono::steady_clock::now() < end) {
      v1::QueueStatus status;
      const auto context = Context();
      EXPECT_TRUE(Simulator()->GetQueueStatus(context.get(), asked, &status).ok());
      if (status.leased() > 0) return true;
    }
    return false;
  }

  grpc::Status Start(const v1::AnalyzeMeshRequest& request, v1::Operation& operation) {
    const auto context = Context();
    return Simulator()->AnalyzeMesh(context.get(), request, &operation);
  }

  // Starts, waits, and gives how it ended.
  v1::Operation Run(const v1::AnalyzeMeshRequest& request) {
    v1::Operation operation;
    const grpc::Status status = Start(request, operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return status.ok() ? Wait(operation.name()) : operation;
  }

  static v1::Analysis ResultOf(const v1::Operation& operation) {
    v1::Analysis analysis;
    EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
    operation.result().UnpackTo(&analysis);
    return analysis;
  }

  int Analyses() {
    v1::ListAnalysesResponse list;
    const auto context = Context();
    EXPECT_TRUE(Simulator()->ListAnalyses(context.get(), {}, &list).ok());
    return list.analyses_size();
  }

  const mesh::GroupedMesh box_ = testing::GroupedBox({100, 10, 10}, {10, 1, 1}, true);
};

}  // namespace mortise::simulator
