// Specifications that are refused.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>

#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, RefusesBadInput) {
  using Specification = v1::DiscoverySpecification;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Refusal([](Specification& s) { s.set_evaluations(0); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.set_window(-1); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.clear_subject(); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.set_subject("templates/absent"); }),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Refusal([](Specification& s) { s.mutable_objectives(1)->set_metric("beauty"); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.mutable_objectives(1)->set_metric("mass"); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.mutable_objectives()->RemoveLast(); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  const auto bounded = [](const std::string& name, double minimum, double maximum) {
    return [=](Specification& s) {
      auto& bound = *s.add_bounds();
      bound.set_parameter(name);
      bound.set_minimum(minimum);
      bound.set_maximum(maximum);
    };
  };
  EXPECT_EQ(Refusal(bounded("x0", nan, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(bounded("x0", 0.8, 0.2)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(bounded("x0", -1, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(bounded("y", 0, 1)), grpc::StatusCode::INVALID_ARGUMENT);

  const auto constrained = [](const std::string& metric, std::optional<double> minimum,
                              std::optional<double> maximum) {
    return [=](Specification& s) {
      auto& constraint = *s.add_constraints();
      constraint.set_metric(metric);
      if (minimum) constraint.set_minimum(*minimum);
      if (maximum) constraint.set_maximum(*maximum);
    };
  };
  EXPECT_EQ(Refusal(constrained("beauty", {}, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(constrained("stress", {}, {})), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(constrained("stress", 2, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(constrained("stress", {}, nan)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([&](Specification& s) {
              constrained("stress", {}, 1)(s);
              constrained("stress", 0, {})(s);
            }),
            grpc::StatusCode::INVALID_ARGUMENT);

  const auto toleranced = [](const std::string& name, double deviation, double deviations) {
    return [=](Specification& s) {
      auto& tolerance = *s.add_tolerances();
      tolerance.set_parameter(name);
      tolerance.set_deviation(deviation);
      s.set_deviations(deviations);
    };
  };
  EXPECT_EQ(Refusal(toleranced("y", 0.01, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  for (const double bad : {0.0, -0.01, nan, 0.9}) {
    EXPECT_EQ(Refusal(toleranced("x0", bad, 1)), grpc::StatusCode::INVALID_ARGUMENT) << bad;
  }
  for (const double bad : {-1.0, nan, 101.0}) {
    EXPECT_EQ(Refusal(toleranced("x0", 0.01, bad)), grpc::StatusCode::INVALID_ARGUMENT) << bad;
  }
  EXPECT_EQ(Refusal([](Specification& s) { s.set_deviations(3); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([&](Specification& s) {
              toleranced("x0", 0.01, 1)(s);
              toleranced("x0", 0.02, 1)(s);
            }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([&](Specification& s) {
              for (const char* name : {"x0", "x1", "x2"}) toleranced(name, 0.01, 1)(s);
            }),
            grpc::StatusCode::INVALID_ARGUMENT)
      << "fifty evaluations are seven designs";

  grpc::ClientContext context;
  v1::GetFrontRequest absent;
  absent.set_name("fronts/absent");
  v1::Front front;
  EXPECT_EQ(fronts_->GetFront(&context, absent, &front).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(evaluator_.evaluations(), 0);
}

}  // namespace
}  // namespace mortise::pareto
