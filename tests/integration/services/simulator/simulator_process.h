// The simulator as a process beside a catalog with the collection's table, for tests to call.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/integration/services/simulator/table_catalog.h"

namespace mortise::simulator {

class SimulatorProcessTest : public ::testing::Test {
 protected:
  static std::unique_ptr<grpc::ClientContext> Context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(100));
    context->set_wait_for_ready(true);
    return context;
  }

  std::unique_ptr<v1::SimulatorService::Stub> Simulator() const {
    return v1::SimulatorService::NewStub(service_.channel());
  }

  // A worker of the simulator's, with more `flags`.
  std::unique_ptr<testing::ChildProcess> StartWorker(
      const std::string& name, const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> command{testing::BuiltProgram("mortise-simulator"),
                                     "--worker",
                                     "--worker-name=" + name,
                                     "--insecure-development",
                                     "--log-level=warning",
                                     "--lease-seconds=2",
                                     "--peer=simulator=" + service_.address(),
                                     "--peer=catalog=" + catalog_.address()};
    command.insert(command.end(), flags.begin(), flags.end());
    return std::make_unique<testing::ChildProcess>(std::move(command));
  }

  // The operation once it is done.
  v1::Operation Wait(const std::string& name) const {
    const auto stub = v1::OperationService::NewStub(service_.channel());
    v1::WaitOperationRequest request;
    request.set_name(name);
    request.set_timeout_seconds(90);
    v1::Operation operation;
    const auto context = Context();
    const grpc::Status status = stub->WaitOperation(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  // A file of an analysis.
  std::string Download(const std::string& analysis, const std::string& file) const {
    v1::DownloadArtifactRequest request;
    request.set_name(analysis);
    request.set_file_name(file);
    const auto context = Context();
    const auto stub = Simulator();
    const auto reader = stub->DownloadArtifact(context.get(), request);
    std::string bytes;
    v1::Chunk chunk;
    while (reader->Read(&chunk)) bytes += chunk.data();
    const grpc::Status status = reader->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    return bytes;
  }

  TableCatalog catalog_;
  testing::ServiceUnderTest service_{"mortise-simulator", {"--peer=catalog=" + catalog_.address()}};
};

}  // namespace mortise::simulator
