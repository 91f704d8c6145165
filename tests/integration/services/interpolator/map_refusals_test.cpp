// Requests that are wrong, and what each is told.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void ExpectField(const grpc::Status& status, const std::string& field) {
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field;
  EXPECT_NE(status.error_message().find(field), std::string::npos)
      << field << ": " << status.error_message();
}

TEST_F(InterpolatorServiceTest, NamesTheFieldOfASpecificationThatIsWrong) {
  using Change = std::function<void(v1::MapSpecification&)>;
  const std::vector<std::pair<std::string, Change>> wrong = {
      {"specification.subject", [](auto& s) { s.set_subject("bowl"); }},
      {"specification.revision", [](auto& s) { s.set_revision(-1); }},
      {"specification.metrics", [](auto& s) { s.clear_metrics(); }},
      {"specification.metrics[1].name", [](auto& s) { s.mutable_metrics(1)->set_name("weight"); }},
      {"specification.metrics[1].name", [](auto& s) { s.mutable_metrics(1)->set_name("mass"); }},
      {"specification.metrics[0].noise_floor",
       [](auto& s) { s.mutable_metrics(0)->set_noise_floor(-1); }},
      {"specification.metrics[0].noise_floor",
       [](auto& s) { s.mutable_metrics(0)->set_noise_floor(kNaN); }},
      {"specification.evaluations", [](auto& s) { s.set_evaluations(3); }},
      {"specification.evaluations",
       [](auto& s) {
         s.set_evaluations(1'000'000);
         for (int i = 0; i < 30; ++i) s.add_metrics()->set_name("m" + std::to_string(i));
       }},
      {"specification.tolerance", [](auto& s) { s.set_tolerance(2); }},
      {"specification.seconds", [](auto& s) { s.set_seconds(-1); }},
      {"specification.most_structures", [](auto& s) { s.set_most_structures(1000); }},
      {"specification.mesh.element_size", [](auto& s) { s.mutable_mesh()->set_element_size(-1); }},
      {"specification.basis",
       [](auto& s) { s.set_basis(static_cast<v1::MapSpecification::Basis>(7)); }},
      {"specification.fixed[0].name", [](auto& s) { s.add_fixed()->set_name("z"); }},
      {"specification.fixed[0].value",
       [](auto& s) {
         s.add_fixed()->set_name("y");
         s.mutable_fixed(0)->set_value(13);
       }},
      {"specification.fixed[0].value",
       [](auto& s) {
         s.add_fixed()->set_name("ribs");
         s.mutable_fixed(0)->set_value(1.5);
       }},
  };
  for (const auto& [field, change] : wrong) ExpectField(Refused(change), field);
  EXPECT_EQ(Refused([](auto& s) { s.set_subject("evaluators/none"); }).error_code(),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(evaluator_.evaluations(), 0);
}

TEST_F(InterpolatorServiceTest, NamesTheFieldOfAVariationThatIsWrong) {
  using Change = std::function<void(v1::MapSpecification&, v1::MapSpecification::Variation&)>;
  const std::vector<std::pair<std::string, Change>> wrong = {
      {"variations[0].parameter", [](auto&, auto& v) { v.set_parameter("z"); }},
      {"variations[0].minimum", [](auto&, auto& v) { v.set_minimum(9); }},
      {"variations[0].maximum", [](auto&, auto& v) { v.set_maximum(13); }},
      {"variations[0].minimum", [](auto&, auto& v) { v.set_minimum(kNaN); }},
      {"variations[0].maximum",
       [](auto&, auto& v) {
         v.set_minimum(11);
         v.set_maximum(11);
       }},
      {"variations[0].minimum", [](auto&, auto& v) { v.set_minimum(12); }},
      {"variations[0].choices", [](auto&, auto& v) { v.add_choices("oak"); }},
      {"variations[1].parameter", [](auto& s, auto&) { s.add_variations()->set_parameter("y"); }},
      {"fixed[0].name", [](auto& s, auto&) { s.add_fixed()->set_name("y"); }},
      {"variations", [](auto&, auto& v) { v.set_parameter("ribs"); }},
      {"variations[0].minimum",
       [](auto&, auto& v) {
         v.set_parameter("ribs");
         v.set_minimum(1.5);
       }},
      {"variations[1].choices[0]",
       [](auto& s, auto&) {
         s.add_variations()->set_parameter("material");
         s.mutable_variations(1)->add_choices("pine");
       }},
      {"variations[1].minimum",
       [](auto& s, auto&) {
         s.add_variations()->set_parameter("material");
         s.mutable_variations(1)->set_minimum(1);
       }},
      {"specification.most_structures",
       [](auto& s, auto&) {
         s.add_variations()->set_parameter("material");
         s.set_most_structures(2);
       }},
      {"specification.evaluations",
       [](auto& s, auto&) {
         s.add_variations()->set_parameter("material");
         s.set_evaluations(20);
       }},
  };
  for (const auto& [field, change] : wrong) {
    ExpectField(Refused([&change = change](v1::MapSpecification& specification) {
                  auto& variation = *specification.add_variations();
                  variation.set_parameter("y");
                  change(specification, variation);
                }),
                field);
  }
}

TEST_F(InterpolatorServiceTest, NamesThePointsThatAreWrong) {
  const v1::DesignMap map = Built(Request(40));
  const auto refused = [&](std::vector<double> points, const std::string& metric = "") {
    v1::EvaluateMapRequest request;
    request.set_name(map.name());
    request.mutable_points()->Add(points.begin(), points.end());
    if (!metric.empty()) request.add_metrics(metric);
    v1::EvaluateMapResponse response;
    return Asked(request, response);
  };
  ExpectField(refused({}), "points");
  ExpectField(refused({0.5}), "points");
  ExpectField(refused({0.5, 11, 0.5}), "points");
  ExpectField(refused({0.5, 11, 0.5, 12.5}), "points[1]");
  ExpectField(refused({0.5, 11, -0.1, 11}), "points[1]");
  ExpectField(refused({0.5, kNaN}), "points[1]");
  ExpectField(refused({0.5, 11}, "weight"), "metrics[0]");
  ExpectField(refused(std::vector<double>(200'002, 0.5)), "points");
  std::vector<double> many;
  for (int i = 0; i < 100'000; ++i) many.insert(many.end(), {0.5, 11});
  EXPECT_EQ(Evaluate(map.name(), many).values_size(), 200'000);

  v1::VerifyMapRequest verify;
  verify.set_name(map.name());
  const auto verify_refused = [&] {
    verify.set_request_id(NewIdentifier());
    grpc::ClientContext context;
    v1::Operation operation;
    return maps_->VerifyMap(&context, verify, &operation);
  };
  verify.set_random_points(1001);
  ExpectField(verify_refused(), "random_points");
  verify.set_random_points(0);
  verify.add_points(0.5);
  ExpectField(verify_refused(), "points");
  verify.set_name("maps/none");
  EXPECT_EQ(verify_refused().error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace mortise::interpolator
