// Fronts of designs that keep to constraints.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, KeepsToConstraints) {
  v1::DiscoverFrontRequest request = Request(150);
  auto& stress = *request.mutable_specification()->add_constraints();
  stress.set_metric("stress");
  stress.set_maximum(3);
  auto& gain = *request.mutable_specification()->add_constraints();
  gain.set_metric("gain");
  gain.set_minimum(-4);
  gain.set_maximum(-0.2);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  ASSERT_GT(front.points_size(), 5);
  EXPECT_GT(front.violating_evaluations(), 0);
  ASSERT_EQ(front.constraint_units_size(), 2);
  double least = 1, most_gain = -4;
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.constraint_metrics_size(), 2);
    EXPECT_LE(10 * (0.7 - point.parameters(0)), 3);
    EXPECT_NEAR(point.constraint_metrics(0), 10 * (0.7 - point.parameters(0)), 1e-12);
    EXPECT_NEAR(point.constraint_metrics(1), point.metrics(1), 1e-12);
    EXPECT_LE(point.metrics(1), -0.2);
    least = std::min(least, point.parameters(0));
    most_gain = std::max(most_gain, point.metrics(1));
  }
  // Up to both limits: x0 = 0.4, and gain -0.2 at x0 = 0.64.
  EXPECT_LT(least, 0.41);
  EXPECT_GT(most_gain, -0.21);

  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_NE(csv.find("gain (kg),stress (kg),gain (kg),piece"), std::string::npos) << csv;
}

TEST_F(ParetoServiceTest, SaysWhatContradictoryConstraintsMiss) {
  v1::DiscoverFrontRequest request = Request(40);
  auto& stress = *request.mutable_specification()->add_constraints();
  stress.set_metric("stress");
  stress.set_maximum(-4);
  const v1::Operation ended = Wait(Discover(request).name());
  ASSERT_EQ(ended.state(), v1::Operation::FAILED);
  const absl::Status error = rpc::FromProto(ended.error());
  EXPECT_TRUE(absl::IsFailedPrecondition(error));
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find("meets all constraints; the nearest does not because stress is "),
            std::string::npos)
      << error;
  EXPECT_NE(error.message().find("not at most -4"), std::string::npos) << error;
}

// "stress" is 10 (0.7 - x0) and "cost" 5 (1 - x1).
TEST_F(ParetoServiceTest, ASingleValueOfAConstraintIsABandThatIsStated) {
  v1::DiscoverFrontRequest request = Request(200);
  auto& constraint = *request.mutable_specification()->add_constraints();
  constraint.set_metric("cost");
  constraint.set_minimum(2.5);
  constraint.set_maximum(2.5);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  EXPECT_GT(front.points_size(), 10);
  for (const v1::FrontPoint& point : front.points()) {
    EXPECT_NEAR(point.constraint_metrics(0), 2.5, 0.00125 + 1e-12);
  }
  ASSERT_EQ(front.remarks_size(), 1);
  EXPECT_NE(front.remarks(0).find("2.49875 to 2.50125"), std::string::npos) << front.remarks(0);

  for (const auto& [minimum, maximum] :
       std::vector<std::pair<double, double>>{{0, 0}, {2.5, 2.5000001}}) {
    EXPECT_EQ(Refusal([&, minimum = minimum, maximum = maximum](v1::DiscoverySpecification& s) {
                auto& narrow = *s.add_constraints();
                narrow.set_metric("cost");
                narrow.set_minimum(minimum);
                narrow.set_maximum(maximum);
              }),
              grpc::StatusCode::INVALID_ARGUMENT);
  }
}

}  // namespace
}  // namespace mortise::pareto
