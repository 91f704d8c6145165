// Maps of functions that are known: built, asked, verified, tagged, stale and deleted.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/random.h"
#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {
namespace {

// x, y of seeded random points.
std::vector<double> RandomPoints(int count) {
  Random random(5);
  std::vector<double> points;
  for (int i = 0; i < count; ++i) {
    points.push_back(random.Uniform());
    points.push_back(10 + 2 * random.Uniform());
  }
  return points;
}

TEST_F(InterpolatorServiceTest, BuildsAMapThatKnowsHowGoodItIs) {
  v1::BuildMapRequest request = Request(150);
  request.add_external_ids("100-4711/A");
  const v1::Operation operation = Wait(Build(request).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  const v1::DesignMap map = MapOf(operation);
  EXPECT_EQ(Get(map.name()).SerializeAsString(), map.SerializeAsString());
  EXPECT_EQ(map.specification().revision(), 3);
  EXPECT_EQ(map.external_ids(0), "100-4711/A");
  ASSERT_EQ(map.parameters_size(), 2);
  EXPECT_EQ(map.parameters(1).name(), "y");
  EXPECT_EQ(map.parameters(1).unit(), "m");
  EXPECT_EQ(map.parameters(1).minimum(), 10);
  ASSERT_EQ(map.fixed_size(), 2);
  EXPECT_EQ(map.fixed(0).name(), "ribs");
  EXPECT_EQ(map.fixed(0).value(), 1);
  EXPECT_LE(map.samples() + map.probes(), 150);
  EXPECT_EQ(map.samples() + map.probes(), evaluator_.evaluations());
  EXPECT_EQ(evaluator_.most_of_one(), 1);
  EXPECT_EQ(map.cut_off_elements(), 0);
  EXPECT_FALSE(map.stale());
  EXPECT_GT(map.bytes(), 0);
  ASSERT_EQ(map.metrics_size(), 2);
  EXPECT_EQ(map.metrics(0).unit(), "kg");

  const std::vector<double> points = RandomPoints(500);
  const v1::EvaluateMapResponse response = Evaluate(map.name(), points);
  ASSERT_EQ(response.values_size(), 1000);
  ASSERT_EQ(response.errors_size(), 1000);
  EXPECT_EQ(response.metrics(1), "stress");
  EXPECT_EQ(response.units(1), "Pa");
  EXPECT_EQ(response.uncovered_size(), 0);
  const double range = map.metrics(0).maximum() - map.metrics(0).minimum();
  double largest = 0;
  for (int i = 0; i < 500; ++i) {
    const double x = points[2 * static_cast<std::size_t>(i)];
    const double y = points[2 * static_cast<std::size_t>(i) + 1];
    largest = std::max(largest, std::abs(response.values(2 * i) - MassOf(x, y)));
    // Linear functions are themselves.
    EXPECT_NEAR(response.values(2 * i + 1), StressOf(x, y), 1);
    EXPECT_GE(response.errors(2 * i), 0);
  }
  EXPECT_LT(largest, 0.03 * range);
  // Within the order of what the map says of itself.
  EXPECT_LT(largest, 3 * map.metrics(0).largest_error());
}

TEST_F(InterpolatorServiceTest, StopsWhereTheToleranceIsMet) {
  v1::BuildMapRequest request = Request(2000);
  request.mutable_specification()->set_tolerance(0.02);
  const v1::DesignMap map = Built(request);
  EXPECT_EQ(map.stop_reason(), "CONVERGED");
  EXPECT_LT(map.samples() + map.probes(), 500);
  EXPECT_LE(map.metrics(0).largest_error(),
            0.02 * (map.metrics(0).maximum() - map.metrics(0).minimum()));
}

TEST_F(InterpolatorServiceTest, GivesGradientsInTheUnitsOfTheParameters) {
  const v1::DesignMap map = Built(Request(60));
  const v1::EvaluateMapResponse response = Evaluate(map.name(), {0.3, 10.7, 0.9, 11.2}, true);
  ASSERT_EQ(response.gradients_size(), 8);  // points x metrics x parameters
  EXPECT_NEAR(response.gradients(2), 1e6, 1);
  EXPECT_NEAR(response.gradients(3), 1e6, 1);
  // Of the mass by y, about.
  EXPECT_NEAR(response.gradients(1), -MassOf(0.3, 10.7, 0), 0.2);
}

TEST_F(InterpolatorServiceTest, GivesTheSameMapForTheSameSeed) {
  const v1::DesignMap first = Built(Request(120)), second = Built(Request(120));
  EXPECT_NE(first.name(), second.name());
  EXPECT_EQ(first.sha256(), second.sha256());
  v1::BuildMapRequest other = Request(120);
  other.mutable_specification()->set_seed(12);
  EXPECT_NE(Built(other).sha256(), first.sha256());
}

TEST_F(InterpolatorServiceTest, MapsEachStructureByItself) {
  v1::BuildMapRequest request = Request(300);
  auto& specification = *request.mutable_specification();
  specification.add_variations()->set_parameter("x");
  specification.add_variations()->set_parameter("y");
  auto& material = *specification.add_variations();
  material.set_parameter("material");
  material.add_choices("steel");
  material.add_choices("oak");
  auto& ribs = *specification.add_variations();
  ribs.set_parameter("ribs");
  ribs.set_minimum(2);
  const v1::DesignMap map = Built(request);
  ASSERT_EQ(map.structures_size(), 4);
  ASSERT_EQ(map.parameters_size(), 4);
  EXPECT_TRUE(map.parameters(2).whole());
  EXPECT_LE(map.samples() + map.probes(), 300);
  const v1::EvaluateMapResponse response =
      Evaluate(map.name(), {0.5, 11, 2, 0, 0.5, 11, 3, 2}, true);
  EXPECT_NEAR(response.values(0), MassOf(0.5, 11, 2, 0), 0.02);
  EXPECT_NEAR(response.values(2), MassOf(0.5, 11, 3, 2), 0.02);
  EXPECT_NEAR(response.values(3), StressOf(0.5, 11, 3), 1);
  EXPECT_EQ(response.gradients(2), 0);  // by ribs

  v1::EvaluateMapRequest asked;
  asked.set_name(map.name());
  for (const double value : {0.5, 11.0, 2.0, 1.0}) asked.add_points(value);
  v1::EvaluateMapResponse refused;
  const grpc::Status status = Asked(asked, refused);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_NE(status.error_message().find("material = 1"), std::string::npos)
      << status.error_message();
}

TEST_F(InterpolatorServiceTest, VerifiesAgainstTheEvaluator) {
  const v1::DesignMap map = Built(Request(100));
  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(map.name());
  request.set_random_points(50);
  request.set_seed(3);
  const v1::DesignMap verified = MapOf(Wait(Verify(request).name()));
  const v1::MapVerification found = Get(map.name()).verification();
  EXPECT_EQ(found.SerializeAsString(), verified.verification().SerializeAsString());
  EXPECT_EQ(found.points(), 50);
  EXPECT_EQ(found.seed(), 3);
  ASSERT_EQ(found.differences_size(), 2);
  EXPECT_GT(found.differences(0).largest(), 0);
  EXPECT_GE(found.differences(0).largest(), found.differences(0).largest_99());
  EXPECT_GE(found.differences(0).largest_99(), found.differences(0).mean());
  EXPECT_LT(found.differences(1).largest(), 1);

  // At a point of the caller's, exactly.
  request.set_request_id(NewIdentifier());
  request.clear_random_points();
  request.clear_seed();
  request.add_points(0.37);
  request.add_points(11.1);
  Wait(Verify(request).name());
  const double mapped = Evaluate(map.name(), {0.37, 11.1}).values(0);
  EXPECT_NEAR(Get(map.name()).verification().differences(0).largest(),
              std::abs(mapped - MassOf(0.37, 11.1)), 1e-12);
}

TEST_F(InterpolatorServiceTest, BecomesStaleWithItsSubject) {
  const v1::DesignMap map = Built(Request(40));
  evaluator_.revision_ = 4;
  // It may not follow yet: then it hears of it again.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!Get(map.name()).stale() && std::chrono::steady_clock::now() < end) {
    events_.Tell("evaluator.created", "evaluators/bowl");
  }
  EXPECT_TRUE(Get(map.name()).stale());
  EXPECT_EQ(Evaluate(map.name(), {0.5, 11}).values_size(), 2);
}

TEST_F(InterpolatorServiceTest, ListsTagsAndDeletesMaps) {
  const v1::DesignMap first = Built(Request(40)), second = Built(Request(40));
  v1::ListMapsRequest list;
  list.set_subject("evaluators/bowl");
  v1::ListMapsResponse listed;
  grpc::ClientContext listing;
  ASSERT_TRUE(maps_->ListMaps(&listing, list, &listed).ok());
  ASSERT_EQ(listed.maps_size(), 2);
  EXPECT_EQ(listed.maps(0).name(), second.name());

  v1::UpdateMapRequest update;
  update.set_request_id(NewIdentifier());
  update.mutable_map()->set_name(first.name());
  (*update.mutable_map()->mutable_labels())["use"] = "demo";
  v1::DesignMap updated;
  grpc::ClientContext updating;
  ASSERT_TRUE(maps_->UpdateMap(&updating, update, &updated).ok());
  EXPECT_EQ(updated.labels().at("use"), "demo");
  EXPECT_EQ(updated.sha256(), first.sha256());

  v1::DeleteMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(first.name());
  v1::DeleteMapResponse response;
  grpc::ClientContext deleting;
  ASSERT_TRUE(maps_->DeleteMap(&deleting, request, &response).ok());
  grpc::Status status;
  Get(first.name(), &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  v1::EvaluateMapRequest asked;
  asked.set_name(first.name());
  asked.add_points(0.5);
  asked.add_points(11);
  v1::EvaluateMapResponse answer;
  EXPECT_EQ(Asked(asked, answer).error_code(), grpc::StatusCode::NOT_FOUND);
  // The other has the same content.
  EXPECT_EQ(Evaluate(second.name(), {0.5, 11}).values_size(), 2);
}

}  // namespace
}  // namespace mortise::interpolator
