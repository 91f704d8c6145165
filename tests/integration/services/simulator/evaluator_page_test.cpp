// docs/evaluators.md: its evaluators are the files beside it, short, and work. They call the
// simulator itself here, which has the same methods as the gateway.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/files.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/simulator_process.h"

namespace mortise::simulator {
namespace {

std::filesystem::path Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::absolute(folder == nullptr ? "." : folder);
}

// What stands in the page's block of this kind.
std::string BlockOf(const std::string& kind) {
  const std::string page = ReadFile(Source() / "docs/evaluators.md").value();
  const std::string fence = "```" + kind + "\n";
  const std::size_t begin = page.find(fence) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

TEST(EvaluatorPage, ShowsTheFilesAndTheyAreShort) {
  for (const auto& [kind, file] : {std::pair("python", "spring.py"), {"cpp", "spring.cpp"}}) {
    const std::string text = BlockOf(kind);
    EXPECT_EQ(text, ReadFile(Source() / "docs/evaluators" / file).value()) << file;
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 40) << file;
  }
}

class EvaluatorPageTest : public SimulatorProcessTest {
 protected:
  EvaluatorPageTest() {
    for (const char* name : {"protos", "docs"}) {
      std::filesystem::create_symlink(Source() / name, folder_.path() / name);
    }
  }

  // A line of shell in the folder where the page's commands are run.
  std::unique_ptr<testing::ChildProcess> Shell(const std::string& command) const {
    return std::make_unique<testing::ChildProcess>(std::vector<std::string>{
        "/bin/bash", "-c", absl::StrCat("cd ", folder_.path().string(), " && ", command)});
  }

  // Waits until a worker has registered its evaluator.
  void AwaitEvaluator(const std::string& name) const {
    const auto stub = v1::EvaluatorService::NewStub(service_.channel());
    v1::GetEvaluatorRequest request;
    request.set_name(name);
    const absl::Time end = absl::Now() + absl::Minutes(1);
    absl::Status status;
    do {
      status = testing::Call(*stub, &v1::EvaluatorService::Stub::GetEvaluator, request).status();
    } while (absl::IsNotFound(status) && absl::Now() < end);
    ASSERT_TRUE(status.ok()) << status;
  }

  const testing::TemporaryFolder folder_;
};

TEST_F(EvaluatorPageTest, ThePythonEvaluatorWorksWhileItsWorkersAreKilled) {
  const std::string block = BlockOf("sh evaluators");
  const std::size_t split = block.find("PYTHONPATH");
  const auto generate = Shell(block.substr(0, split));
  ASSERT_EQ(generate->Wait(), 0) << generate->Output();
  const std::string start =
      "exec env " +
      absl::StrReplaceAll(block.substr(split), {{"127.0.0.1:7700", service_.address()}});
  const auto doomed = Shell(start);
  const auto steady = Shell(start);
  AwaitEvaluator("evaluators/spring");
  v1::EvaluateBatchRequest request;
  request.set_subject("evaluators/spring");
  request.add_metrics("stiffness");
  for (int i = 0; i < 60; ++i) {
    v1::DesignPoint& point = *request.add_points();
    for (const double value : {0.002 + 4e-5 * i, 0.03, 8.0, 0.0}) point.add_parameters(value);
  }
  const auto stub = v1::EvaluatorService::NewStub(service_.channel());
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = stub->EvaluateBatch(&context, request);
  v1::EvaluationResult result;
  int results = 0;
  while (reader->Read(&result)) {
    if (++results == 3) doomed->Signal(SIGKILL);
    ASSERT_EQ(result.metrics_size(), 1) << result.error().message() << steady->Output();
    const double wire = request.points(result.index()).parameters(0);
    const double expected = 80e9 * std::pow(wire, 4) / (8 * std::pow(0.03, 3) * 8);
    EXPECT_NEAR(result.metrics(0).value(), expected, 1e-9 * expected);
    EXPECT_EQ(result.metrics(0).unit(), "N/m");
  }
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_EQ(results, 60);
}

TEST_F(EvaluatorPageTest, TheProgramInCppEvaluates) {
  const testing::ChildProcess program(
      {testing::BuiltProgram("spring-evaluator"), service_.address()});
  AwaitEvaluator("evaluators/stiffness");
  v1::EvaluateBatchRequest request;
  request.set_subject("evaluators/stiffness");
  request.add_metrics("stiffness");
  v1::DesignPoint& point = *request.add_points();
  for (const double value : {0.004, 0.04}) point.add_parameters(value);
  const auto stub = v1::EvaluatorService::NewStub(service_.channel());
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = stub->EvaluateBatch(&context, request);
  v1::EvaluationResult result;
  ASSERT_TRUE(reader->Read(&result));
  ASSERT_EQ(result.metrics_size(), 1) << result.error().message();
  EXPECT_NEAR(result.metrics(0).value(), 5000, 1e-6);
  EXPECT_TRUE(reader->Finish().ok());
}

}  // namespace
}  // namespace mortise::simulator
