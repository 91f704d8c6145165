// A model that is saved with its loads is analysed by finite elements: mortise-composer, the
// catalog and the simulator as real processes.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/composer/composer_house.h"
#include "tests/support/child_process.h"

namespace mortise::testing {
namespace {

double ValueOf(const v1::Analysis& analysis, const std::string& name) {
  for (const v1::Metric& metric : analysis.metrics()) {
    if (metric.name() == name) return metric.value();
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
}

// Waits for an analysis to end.
absl::StatusOr<v1::Analysis> Analyze(const ServiceUnderTest& simulator,
                                     const v1::AnalyzeDesignRequest& request) {
  const auto stub = v1::SimulatorService::NewStub(simulator.channel());
  const auto started = Call(*stub, &v1::SimulatorService::Stub::AnalyzeDesign, request);
  if (!started.ok()) return started.status();
  const auto operations = v1::OperationService::NewStub(simulator.channel());
  v1::WaitOperationRequest wait;
  wait.set_name(started->name());
  wait.set_timeout_seconds(90);
  v1::Operation done = *started;
  for (int round = 0; round < 3 && done.state() != v1::Operation::SUCCEEDED; ++round) {
    const auto waited = Call(*operations, &v1::OperationService::Stub::WaitOperation, wait);
    if (!waited.ok()) return waited.status();
    if (waited->has_error()) return absl::InternalError(waited->error().message());
    done = *waited;
  }
  v1::Analysis analysis;
  if (!done.result().UnpackTo(&analysis)) return absl::InternalError(done.ShortDebugString());
  return analysis;
}

TEST(ComposerLoadsTest, ATableBearsWhatAStandardAsksOfIt) {
  ComposerHouse house;
  v1::Model model = house.New("table");
  model = house.Add(model, "dining-table", "", "table").value_or(model);
  v1::SaveModelRequest save;
  save.set_request_id("save");
  save.set_name(model.name());
  save.set_revision(model.revision());
  save.set_template_id("loaded-table");
  save.set_with_loads(true);
  const auto saved = Call(house.composer(), &v1::ComposerService::Stub::SaveModel, save);
  ASSERT_TRUE(saved.ok()) << saved.status();
  const std::string catalog = "--peer=catalog=" + house.catalog_process().address();
  ServiceUnderTest simulator("mortise-simulator", {catalog});
  const ChildProcess worker({BuiltProgram("mortise-simulator"), "--worker", "--worker-name=only",
                             "--insecure-development", "--log-level=warning",
                             "--peer=simulator=" + simulator.address(), catalog});
  v1::AnalyzeDesignRequest request;
  request.set_request_id("analyze");
  request.set_template_(saved->template_());
  request.mutable_mesh()->set_linear(true);
  const auto analysis = Analyze(simulator, request);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  // 100 kg bend a top of 28 mm on its frame by less than a millimetre, and do not break it.
  EXPECT_GT(ValueOf(*analysis, "max_displacement"), 1e-6);
  EXPECT_LT(ValueOf(*analysis, "max_displacement"), 1e-3);
  EXPECT_GT(ValueOf(*analysis, "stress_ratio"), 0);
  EXPECT_LT(ValueOf(*analysis, "stress_ratio"), 0.5);
}

}  // namespace
}  // namespace mortise::testing
