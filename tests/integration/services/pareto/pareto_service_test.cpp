// mortise-pareto as a real process: discovery from start to front.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/identifiers.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, DiscoversPicksListsAndExports) {
  const v1::Operation operation = Wait(Discover(Request(200)).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_EQ(operation.progress().total(), 200);
  for (const char* told : {"hypervolume 0.", " cells covered", " pieces followed"}) {
    EXPECT_NE(operation.progress().message().find(told), std::string::npos)
        << operation.progress().message();
  }
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.evaluations(), 200);
  EXPECT_EQ(evaluator_.evaluations(), 200);
  EXPECT_EQ(front.specification().revision(), 3);
  EXPECT_EQ(front.stop_reason(), "BUDGET");
  EXPECT_GT(front.points_size(), 20);
  EXPECT_GT(front.hypervolume(), 0.5);
  EXPECT_EQ(front.metric_names(1), "gain");
  for (const auto& point : front.points()) EXPECT_LE(point.metrics(1), 0);  // not negated

  v1::PickPointRequest pick;
  pick.set_name(front.name());
  pick.mutable_metric()->set_name("mass");
  pick.mutable_metric()->set_value(0.25);
  v1::PickPointResponse picked;
  ASSERT_TRUE(Asked(pick, picked).ok());
  EXPECT_NEAR(picked.metrics(0).value(), 0.25, 0.1);
  EXPECT_EQ(picked.parameters_size(), kDimensions);
  EXPECT_EQ(front.points(picked.index()).metrics(0), picked.metrics(0).value());

  v1::ListFrontsResponse listed;
  grpc::ClientContext list_context;
  ASSERT_TRUE(fronts_->ListFronts(&list_context, {}, &listed).ok());
  ASSERT_EQ(listed.fronts_size(), 1);
  EXPECT_EQ(listed.fronts(0).name(), front.name());
  EXPECT_EQ(listed.fronts(0).points_size(), 0);

  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), front.points_size() + 1);
  EXPECT_EQ(csv.rfind("x0,x1,x2,x3,x4,mass (kg),gain (kg),piece", 0), 0u);
  EXPECT_NE(Export(front.name(), v1::ExportFrontRequest::SVG).find("<svg"), std::string::npos);
  EXPECT_EQ(Export(front.name(), v1::ExportFrontRequest::JSON).front(), '{');
  EXPECT_EQ(Export(front.name(), v1::ExportFrontRequest::PNG).substr(1, 3), "PNG");
}

TEST_F(ParetoServiceTest, TellsHowWellItsSurrogateForetold) {
  v1::DiscoverFrontRequest request = Request(40);
  request.mutable_specification()->set_surrogate(v1::DiscoverySpecification::SURROGATE_AUTOMATIC);
  const v1::Operation operation = Wait(Discover(request).name());
  EXPECT_NE(operation.progress().message().find("surrogate off by"), std::string::npos)
      << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.evaluations(), 40);
  EXPECT_GT(front.surrogate_quality().proposals(), 8);
  EXPECT_GT(front.surrogate_quality().predictions(), front.surrogate_quality().proposals());
  EXPECT_GT(front.surrogate_quality().within_two_deviations(), 0.5);
  EXPECT_GT(front.surrogate_quality().median_error(), 0);

  request.set_request_id(NewIdentifier());
  request.mutable_specification()->set_surrogate(v1::DiscoverySpecification::SURROGATE_NEVER);
  EXPECT_FALSE(FrontOf(Wait(Discover(request).name())).has_surrogate_quality());
  EXPECT_EQ(Refusal([](auto& specification) {
              specification.set_surrogate(static_cast<v1::DiscoverySpecification::Surrogate>(9));
            }),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ParetoServiceTest, DiscoversFrontsOfFourMetrics) {
  v1::DiscoverFrontRequest request = Request(300);
  for (const char* metric : {"stress", "cost"}) {
    request.mutable_specification()->add_objectives()->set_metric(metric);
  }
  const v1::Operation operation = Wait(Discover(request).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.metric_names_size(), 4);
  ASSERT_GT(front.points_size(), 20);
  double cheapest = 5;
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.metrics_size(), 4);
    ASSERT_EQ(point.embedding_size(), 3);
    cheapest = std::min(cheapest, point.metrics(3));
  }
  EXPECT_LT(cheapest, 0.7);  // 0.5 is possible
  EXPECT_LE(front.cells_covered(), 75);

  v1::PickPointRequest pick;
  pick.set_name(front.name());
  for (int i = 0; i < 3; ++i) pick.add_embedding(0.5);
  v1::PickPointResponse picked;
  ASSERT_TRUE(Asked(pick, picked).ok());
  EXPECT_EQ(picked.metrics_size(), 4);
  EXPECT_EQ(picked.neighbours_size(), 8);
  pick.add_embedding(0.5);
  EXPECT_EQ(Asked(pick, picked).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Export(front.name(), v1::ExportFrontRequest::PNG).substr(1, 3), "PNG");
  EXPECT_NE(Export(front.name(), v1::ExportFrontRequest::SVG).find("best stress"),
            std::string::npos);
}

TEST_F(ParetoServiceTest, CountsOnTolerances) {
  v1::DiscoverFrontRequest request = Request(300);
  auto& tolerance = *request.mutable_specification()->add_tolerances();
  tolerance.set_parameter("x0");
  tolerance.set_deviation(0.03);
  request.mutable_specification()->set_deviations(2);
  const int before = evaluator_.evaluations();
  const v1::Operation operation = Wait(Discover(request).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_EQ(operation.progress().total(), 300);
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.evaluations(), 100);
  EXPECT_EQ(front.subject_evaluations(), 300);
  EXPECT_EQ(evaluator_.evaluations() - before, 300);
  ASSERT_GT(front.points_size(), 5);
  const double deviation = 0.03 / std::sqrt(3);
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.metric_means_size(), 2);
    EXPECT_NEAR(point.metric_means(0), point.parameters(0), 1e-9);
    EXPECT_NEAR(point.metric_deviations(0), deviation, 1e-9);
    EXPECT_NEAR(point.metrics(0), point.parameters(0) + 2 * deviation, 1e-9);
    // The gain is to be large: what is robust is less than its mean.
    EXPECT_NEAR(point.metrics(1), point.metric_means(1) - 2 * point.metric_deviations(1), 1e-9);
  }
  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_NE(csv.find("mean mass (kg),deviation of mass (kg)"), std::string::npos) << csv;
}

TEST_F(ParetoServiceTest, SaysThatMetricsDoNotConflict) {
  v1::DiscoverFrontRequest request = Request(60);
  request.mutable_specification()->mutable_objectives(1)->set_metric("weight");
  request.mutable_specification()->mutable_objectives(1)->set_maximize(false);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(front.points_size(), 1);
  ASSERT_GT(front.remarks_size(), 0);
  EXPECT_NE(front.remarks(0).find("'mass' and 'weight'"), std::string::npos) << front.remarks(0);
}

}  // namespace
}  // namespace mortise::pareto
