// Discovery over choices and whole numbers.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

TEST_F(ParetoServiceTest, MergesFrontsOfChoicesAndWholeNumbers) {
  v1::DiscoverFrontRequest request = Request(300);
  request.mutable_specification()->set_subject("evaluators/mixed");
  const v1::Operation operation = Wait(Discover(request).name());
  EXPECT_NE(operation.progress().message().find("9 of 9 combinations tried"), std::string::npos)
      << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  EXPECT_TRUE(evaluator_.whole());
  EXPECT_EQ(front.combinations().possible(), 9);
  ASSERT_EQ(front.parameter_choices_size(), kDimensions);
  EXPECT_EQ(front.parameter_choices(0).names_size(), 0);
  EXPECT_EQ(front.parameter_choices(3).names(2), "steel");
  ASSERT_GT(front.points_size(), 10);
  int birch = 0;
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.choices_size(), kDimensions);
    EXPECT_EQ(point.choices(0), "");
    EXPECT_EQ(point.choices(3),
              front.parameter_choices(3).names(static_cast<int>(point.parameters(3))));
    birch += point.choices(3) == "birch" && point.parameters(4) == 2;
  }
  EXPECT_GT(2 * birch, front.points_size());
  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_EQ(csv.rfind("x0,x1,x2,x3,x3 (choice),x4,mass (kg)", 0), 0u) << csv.substr(0, 60);
  EXPECT_NE(csv.find(",1,birch,2,"), std::string::npos);

  auto& bound = *request.mutable_specification()->add_bounds();
  request.set_request_id(NewIdentifier());
  bound.set_parameter("x3");
  bound.add_choices("steel");
  bound.add_choices("oak");
  const v1::Front allowed = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(allowed.combinations().possible(), 6);
  for (const v1::FrontPoint& point : allowed.points()) EXPECT_NE(point.choices(3), "birch");

  // From the front before, whose choice is no longer allowed in most designs.
  request.set_request_id(NewIdentifier());
  request.mutable_specification()->add_start_from(front.name());
  request.mutable_specification()->add_start_from(allowed.name());
  const v1::Front again = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(again.remarks_size(), 0) << again.remarks(0);
  EXPECT_GT(again.points_size(), 0);
  for (const v1::FrontPoint& point : again.points()) EXPECT_NE(point.choices(3), "birch");
}

TEST_F(ParetoServiceTest, RefusesTolerancesOfChoicesAndWholeNumbers) {
  const auto refused = [&](const std::string& parameter) {
    v1::DiscoverFrontRequest request = Request(100);
    request.mutable_specification()->set_subject("evaluators/mixed");
    auto& tolerance = *request.mutable_specification()->add_tolerances();
    tolerance.set_parameter(parameter);
    tolerance.set_deviation(0.1);
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = fronts_->DiscoverFront(&context, request, &operation);
    return DetailOf(rpc::FromGrpc(status)).field;
  };
  EXPECT_EQ(refused("x3"), "specification.tolerances[0].parameter");
  EXPECT_EQ(refused("x4"), "specification.tolerances[0].parameter");
  EXPECT_EQ(refused("x0"), "");
}

TEST_F(ParetoServiceTest, RefusesChoicesThatAreNone) {
  const auto refused = [&](const std::string& parameter, double minimum, double maximum,
                           const std::vector<std::string>& choices) {
    v1::DiscoverFrontRequest request = Request(100);
    request.mutable_specification()->set_subject("evaluators/mixed");
    auto& bound = *request.mutable_specification()->add_bounds();
    bound.set_parameter(parameter);
    bound.set_minimum(minimum);
    bound.set_maximum(maximum);
    bound.mutable_choices()->Add(choices.begin(), choices.end());
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = fronts_->DiscoverFront(&context, request, &operation);
    return DetailOf(rpc::FromGrpc(status)).field;
  };
  const std::string field = "specification.bounds[0]";
  EXPECT_EQ(refused("x3", 0, 0, {"oak", "teak"}), field + ".choices[1]");
  EXPECT_EQ(refused("x3", 0, 0, {"oak", "oak"}), field + ".choices[1]");
  EXPECT_EQ(refused("x3", 0, 1, {}), field + ".maximum") << "no range";
  EXPECT_EQ(refused("x3", 3, 3, {}), field + ".minimum");
  EXPECT_EQ(refused("x3", 0.5, 0.5, {}), field + ".minimum");
  EXPECT_EQ(refused("x3", 0, 1, {"oak"}), field + ".maximum");
  EXPECT_EQ(refused("x0", 0, 0, {"oak"}), field + ".choices") << "a number";
  EXPECT_EQ(evaluator_.evaluations(), 0);
}

}  // namespace
}  // namespace mortise::pareto
