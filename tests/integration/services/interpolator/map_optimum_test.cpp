// The best designs of maps whose functions are known.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {
namespace {

class MapOptimumTest : public InterpolatorServiceTest {
 protected:
  std::string BuildWith(const std::function<void(v1::MapSpecification&)>& change) {
    v1::BuildMapRequest request = Request(300);
    change(*request.mutable_specification());
    return Built(request).name();
  }
  static v1::OptimizeMapRequest Least(const std::string& map, const std::string& objective) {
    v1::OptimizeMapRequest request;
    request.set_name(map);
    request.set_objective(objective);
    request.set_seed(3);
    return request;
  }
  grpc::Status Ask(const v1::OptimizeMapRequest& request, v1::OptimizeMapResponse& response) {
    grpc::ClientContext context;
    return maps_->OptimizeMap(&context, request, &response);
  }
  v1::OptimizeMapResponse Optimum(const v1::OptimizeMapRequest& request) {
    v1::OptimizeMapResponse response;
    const grpc::Status status = Ask(request, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }
};

TEST_F(MapOptimumTest, IsWhereTheFunctionHasItsOwn) {
  for (const auto basis : {v1::MapSpecification::LINEAR, v1::MapSpecification::CUBIC}) {
    const std::string map = BuildWith([basis](auto& s) { s.set_basis(basis); });
    v1::OptimizeMapRequest request = Least(map, "mass");
    request.set_maximize(true);
    const v1::OptimizeMapResponse most = Optimum(request);
    ASSERT_EQ(most.parameters_size(), 2);
    // sin(2 x + 0.5) is 1 there.
    EXPECT_NEAR(most.parameters(0), (M_PI / 2 - 0.5) / 2, 0.08);
    EXPECT_NEAR(most.parameters(1), 10, 1e-6);
    EXPECT_NEAR(most.objective(), 1.25, 0.02);
    EXPECT_EQ(most.objective(), most.values(0));
    EXPECT_EQ(most.violation(), 0);
    EXPECT_EQ(most.starts(), 16);
    EXPECT_GT(most.starts_that_agree(), 0);
    ASSERT_EQ(most.design_size(), 4);
    EXPECT_EQ(most.design(1).name(), "y");
    EXPECT_EQ(most.design(2).name(), "ribs");
    EXPECT_EQ(most.design(2).value(), 1);
    EXPECT_EQ(Optimum(request).SerializeAsString(), most.SerializeAsString());
  }
}

TEST_F(MapOptimumTest, KeepsLimitsAndWhatIsFixed) {
  const std::string map = BuildWith([](auto&) {});
  v1::OptimizeMapRequest request = Least(map, "mass * ribs");
  v1::OptimizeMapRequest::Limit& limit = *request.add_limits();
  limit.set_metric("stress");
  limit.set_maximum(2e6);  // x + y - 10 <= 1
  const v1::OptimizeMapResponse least = Optimum(request);
  EXPECT_NEAR(least.parameters(0), 0, 1e-3);
  EXPECT_NEAR(least.parameters(1), 11, 1e-3);
  EXPECT_LE(least.values(1), 2e6 * (1 + 1e-6));
  v1::ParameterValue& fixed = *request.add_fixed();
  fixed.set_name("x");
  fixed.set_value(0.5);
  const v1::OptimizeMapResponse held = Optimum(request);
  EXPECT_EQ(held.parameters(0), 0.5);
  EXPECT_NEAR(held.parameters(1), 10.5, 1e-3);
  request.mutable_limits(0)->set_maximum(1e6);
  const v1::OptimizeMapResponse missed = Optimum(request);
  EXPECT_GT(missed.violation(), 0.1);
  EXPECT_NEAR(missed.parameters(1), 10, 1e-3);
}

TEST_F(MapOptimumTest, ChoosesAmongStructures) {
  const std::string map = BuildWith([](auto& s) {
    for (const char* name : {"x", "y", "material"}) s.add_variations()->set_parameter(name);
  });
  const v1::OptimizeMapResponse least = Optimum(Least(map, "mass"));
  ASSERT_EQ(least.parameters_size(), 3);
  EXPECT_EQ(least.parameters(2), 0);  // oak is lightest
  v1::OptimizeMapRequest request = Least(map, "mass");
  v1::ParameterValue& fixed = *request.add_fixed();
  fixed.set_name("material");
  fixed.set_value(2);
  const v1::OptimizeMapResponse steel = Optimum(request);
  EXPECT_EQ(steel.parameters(2), 2);
  EXPECT_NEAR(steel.objective() - least.objective(), 2, 0.05);
}

TEST_F(MapOptimumTest, NamesTheFieldThatIsWrong) {
  const std::string map = BuildWith([](auto&) {});
  using Change = std::function<void(v1::OptimizeMapRequest&)>;
  const auto fix = [](const char* name, double value) {
    return [name, value](v1::OptimizeMapRequest& request) {
      request.add_fixed()->set_name(name);
      request.mutable_fixed(0)->set_value(value);
    };
  };
  const std::vector<std::pair<std::string, Change>> wrong = {
      {"objective", [](auto& r) { r.clear_objective(); }},
      {"objective", [](auto& r) { r.set_objective("weight"); }},
      {"objective", [](auto& r) { r.set_objective("mass +"); }},
      {"objective", [](auto& r) { r.set_objective("sqrt(0 - mass)"); }},
      {"starts", [](auto& r) { r.set_starts(-1); }},
      {"starts", [](auto& r) { r.set_starts(100'000); }},
      {"limits[0].metric", [](auto& r) { r.add_limits()->set_metric("weight"); }},
      {"limits[0]", [](auto& r) { r.add_limits()->set_metric("mass"); }},
      {"fixed[0].name", fix("ribs", 2)},
      {"fixed[0].value", fix("x", 2)},
      {"fixed[0].value", fix("x", std::numeric_limits<double>::quiet_NaN())},
  };
  for (const auto& [field, change] : wrong) {
    v1::OptimizeMapRequest request = Least(map, "mass");
    change(request);
    v1::OptimizeMapResponse response;
    const grpc::Status status = Ask(request, response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field;
    EXPECT_NE(status.error_message().find(field), std::string::npos)
        << field << ": " << status.error_message();
  }
  v1::OptimizeMapResponse response;
  EXPECT_EQ(Ask(Least("maps/none", "mass"), response).error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace mortise::interpolator
