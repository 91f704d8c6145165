// A map of the collection's table over two of its parameters, evaluated by the simulator's workers.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>

#include "common/base/identifiers.h"
#include "mortise/v1/interpolator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/integration/services/simulator/simulator_process.h"

namespace mortise::interpolator {
namespace {

using Service = v1::InterpolatorService::Stub;

class TableMapTest : public simulator::SimulatorProcessTest {
 protected:
  // What an operation made, once it is done; an empty one if it does not come to an end.
  v1::DesignMap ResultOf(const v1::Operation& started) {
    const auto stub = v1::OperationService::NewStub(interpolator_.channel());
    v1::WaitOperationRequest request;
    request.set_name(started.name());
    request.set_timeout_seconds(60);
    v1::DesignMap map;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(240);
    while (std::chrono::steady_clock::now() < end) {
      const auto operation =
          testing::Call(*stub, &v1::OperationService::Stub::WaitOperation, request);
      EXPECT_TRUE(operation.ok()) << operation.status();
      if (!operation.ok()) break;
      if (operation->state() < v1::Operation::SUCCEEDED) continue;
      EXPECT_TRUE(operation->result().UnpackTo(&map)) << operation->ShortDebugString();
      break;
    }
    return map;
  }

  testing::ServiceUnderTest interpolator_{
      "mortise-interpolator",
      {"--peer=catalog=" + catalog_.address(), "--peer=simulator=" + service_.address()}};
};

// Another mesh changes how much it gives way, and not what it weighs.
void ExpectNoise(const v1::DesignMap& map) {
  EXPECT_EQ(map.noise_evaluations(), 1);
  EXPECT_LE(map.samples() + map.probes() + map.noise_evaluations(), 20);
  EXPECT_TRUE(map.metrics(0).noise_estimated());
  EXPECT_LT(map.metrics(0).noise_floor(), 1e-9 * map.metrics(0).maximum());
  EXPECT_TRUE(map.metrics(1).noise_estimated());
  EXPECT_GT(map.metrics(1).noise_floor(), 1e-6 * map.metrics(1).maximum());
  EXPECT_LT(map.metrics(1).noise_floor(), map.metrics(1).maximum());
}

TEST_F(TableMapTest, IsBuiltByWorkersAndAnswersWithoutThem) {
  auto first = StartWorker("w1");
  auto second = StartWorker("w2");
  const auto maps = v1::InterpolatorService::NewStub(interpolator_.channel());
  v1::BuildMapRequest request;
  request.set_request_id(NewIdentifier());
  auto& specification = *request.mutable_specification();
  specification.set_subject("templates/table");
  specification.set_evaluations(20);
  specification.add_metrics()->set_name("mass");
  specification.add_metrics()->set_name("max_displacement");
  specification.mutable_mesh()->set_element_size(0.3);
  specification.mutable_mesh()->set_linear(true);
  auto& length = *specification.add_variations();
  length.set_parameter("length");
  length.set_minimum(1.2);
  length.set_maximum(1.8);
  specification.add_variations()->set_parameter("width");
  const auto started = testing::Call(*maps, &Service::BuildMap, request);
  ASSERT_TRUE(started.ok()) << started.status();
  const v1::DesignMap map = ResultOf(*started);
  ASSERT_EQ(map.metrics_size(), 2);
  EXPECT_EQ(map.failed_evaluations(), 0);
  EXPECT_EQ(map.specification().revision(), 1);
  ASSERT_EQ(map.parameters_size(), 2);
  ExpectNoise(map);

  v1::VerifyMapRequest verify;
  verify.set_request_id(NewIdentifier());
  verify.set_name(map.name());
  verify.set_random_points(4);
  const auto verifying = testing::Call(*maps, &Service::VerifyMap, verify);
  ASSERT_TRUE(verifying.ok()) << verifying.status();
  const v1::MapVerification found = ResultOf(*verifying).verification();
  EXPECT_EQ(found.points(), 4);
  EXPECT_EQ(found.failed(), 0);
  ASSERT_EQ(found.differences_size(), 2);
  // The mass of a table is all but linear in its length and width.
  EXPECT_LT(found.differences(0).largest(),
            0.02 * (map.metrics(0).maximum() - map.metrics(0).minimum()));

  first.reset();
  second.reset();
  v1::EvaluateMapRequest asked;
  asked.set_name(map.name());
  asked.add_points(1.5);
  asked.add_points((map.parameters(1).minimum() + map.parameters(1).maximum()) / 2);
  const auto answer = testing::Call(*maps, &Service::EvaluateMap, asked);
  ASSERT_TRUE(answer.ok()) << answer.status();
  ASSERT_EQ(answer->values_size(), 2);
  EXPECT_GT(answer->values(0), map.metrics(0).minimum());
  EXPECT_LT(answer->values(0), map.metrics(0).maximum());
  EXPECT_EQ(answer->units(1), "m");
}

}  // namespace
}  // namespace mortise::interpolator
