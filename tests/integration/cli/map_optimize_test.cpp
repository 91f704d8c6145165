// mortise map optimize against a gateway that the test plays: what is found on the map stands
// beside what the evaluator says of it.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/interpolator.grpc.pb.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

// A map of "length" at the height 0.5, on which a design of 2 m has the mass 4 kg and the mean
// stress 3 MPa.
class PlayedInterpolator final : public v1::InterpolatorService::Service {
 public:
  grpc::Status GetMap(grpc::ServerContext*, const v1::GetMapRequest* request,
                      v1::DesignMap* response) override {
    response->set_name(request->name());
    response->mutable_specification()->set_subject("templates/beam");
    response->mutable_specification()->set_revision(3);
    response->mutable_specification()->mutable_mesh()->set_element_size(0.01);
    auto& parameter = *response->add_parameters();
    parameter.set_name("length");
    parameter.set_unit("m");
    parameter.set_maximum(5);
    for (const auto& [name, unit] : {std::pair{"mass", "kg"}, std::pair{"mean_von_mises", "Pa"}}) {
      auto& metric = *response->add_metrics();
      metric.set_name(name);
      metric.set_unit(unit);
    }
    return grpc::Status::OK;
  }

  grpc::Status OptimizeMap(grpc::ServerContext*, const v1::OptimizeMapRequest* request,
                           v1::OptimizeMapResponse* response) override {
    asked = *request;
    response->add_parameters(2);
    for (const auto& [name, value] : {std::pair{"length", 2.0}, std::pair{"height", 0.5}}) {
      auto& parameter = *response->add_design();
      parameter.set_name(name);
      parameter.set_value(value);
    }
    for (const char* const name : {"mass", "mean_von_mises"}) response->add_metrics(name);
    for (const char* const unit : {"kg", "Pa"}) response->add_units(unit);
    for (const double value : {4.0, 3e6}) response->add_values(value);
    for (const double error : {0.0, 2e5}) response->add_errors(error);
    response->set_objective(16);
    response->set_starts(16);
    response->set_starts_that_agree(12);
    return grpc::Status::OK;
  }

  v1::OptimizeMapRequest asked;
};

class PlayedEvaluator final : public v1::EvaluatorService::Service {
 public:
  grpc::Status DescribeDesignSpace(grpc::ServerContext*, const v1::DescribeDesignSpaceRequest*,
                                   v1::DesignSpace* response) override {
    response->set_subject("templates/beam");
    response->set_revision(3);
    for (const char* const name : {"height", "length", "width"}) {
      auto& parameter = *response->add_parameters();
      parameter.set_name(name);
      parameter.set_default_value(0.25);
    }
    return grpc::Status::OK;
  }

  grpc::Status EvaluateBatch(grpc::ServerContext*, const v1::EvaluateBatchRequest* request,
                             grpc::ServerWriter<v1::EvaluationResult>* writer) override {
    asked = *request;
    if (!failure.ok()) return rpc::ToGrpc(failure);
    v1::EvaluationResult result;
    for (int i = 0; i < request->metrics_size() && i < told; ++i) {
      auto& metric = *result.add_metrics();
      metric.set_name(request->metrics(i));
      metric.set_unit(i == 0 ? "kg" : "Pa");
      metric.set_value(i == 0 ? 4 : 3.25e6);
    }
    writer->Write(result);
    return grpc::Status::OK;
  }

  v1::EvaluateBatchRequest asked;
  absl::Status failure;
  int told = 2;  // of the metrics that are asked for
};

class MapOptimize : public ::testing::Test {
 protected:
  MapOptimize() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&interpolator_);
    builder.RegisterService(&evaluator_);
    server_ = builder.BuildAndStart();
    session_.gateway.address = "127.0.0.1:" + std::to_string(port);
  }
  ~MapOptimize() override { server_->Shutdown(std::chrono::system_clock::now()); }

  absl::Status Run(std::initializer_list<std::string> more, Output& output) {
    std::vector<std::string> arguments{"map", "optimize", "maps/m"};
    arguments.insert(arguments.end(), more);
    return RunCommandLine(arguments, session_, output);
  }

  Json Document(std::initializer_list<std::string> more) {
    Output output(Output::Form::kSilent);
    const absl::Status status = Run(more, output);
    EXPECT_TRUE(status.ok()) << status;
    return Json::parse(output.last_document(), nullptr, /*allow_exceptions=*/false);
  }

  // What it prints for people, and how it ends.
  std::pair<std::string, absl::Status> Print(std::initializer_list<std::string> more) {
    Output output(Output::Form::kText);
    ::testing::internal::CaptureStdout();
    absl::Status status = Run(more, output);
    return {::testing::internal::GetCapturedStdout(), std::move(status)};
  }

  PlayedInterpolator interpolator_;
  PlayedEvaluator evaluator_;

 private:
  std::unique_ptr<grpc::Server> server_;
  Session session_;
};

TEST_F(MapOptimize, HasTheDesignEvaluatedAsTheMapWas) {
  const Json document =
      Document({"--minimize", "mass * length * height * 4", "--limit", "mean_von_mises=:3.5MPa"});
  EXPECT_EQ(evaluator_.asked.revision(), 3);
  EXPECT_EQ(evaluator_.asked.mesh().element_size(), 0.01);
  ASSERT_EQ(evaluator_.asked.points_size(), 1);
  EXPECT_THAT(evaluator_.asked.points(0).parameters(), ::testing::ElementsAre(0.5, 2, 0.25));
  EXPECT_EQ(document["metrics"]["mean_von_mises"], 3e6);
  EXPECT_EQ(document["evaluated"]["mean_von_mises"], 3.25e6);
  EXPECT_EQ(document["objective"], 16);
  EXPECT_EQ(document["evaluated_objective"], 16);
  EXPECT_EQ(document["missed"], Json::object());
}

TEST_F(MapOptimize, SaysWhichLimitsTheEvaluatedDesignMisses) {
  const std::initializer_list<std::string> asked{"--minimize", "mass + mean_von_mises / 1e6",
                                                 "--limit", "mean_von_mises=1MPa:3MPa"};
  const Json document = Document(asked);
  EXPECT_EQ(document["missed"], Json::parse(R"({"mean_von_mises": 250000.0})"));
  EXPECT_DOUBLE_EQ(document["evaluated_objective"], 7.25);
  const auto [text, status] = Print(asked);
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_THAT(text, HasSubstr("objective 16 by the map, 7.25 evaluated; 12 of 16 searches"));
  EXPECT_THAT(text, HasSubstr("misses the limit of mean_von_mises by"));
  const Json low = Document({"--maximize", "mass", "--limit", "mean_von_mises=4MPa:"});
  EXPECT_EQ(low["missed"], Json::parse(R"({"mean_von_mises": 750000.0})"));
}

TEST_F(MapOptimize, AsksNoEvaluatorWhereNothingIsToBeVerified) {
  const Json document = Document({"--minimize", "mass", "--unverified"});
  EXPECT_EQ(evaluator_.asked.points_size(), 0);
  EXPECT_FALSE(document.contains("evaluated"));
  EXPECT_FALSE(document.contains("evaluated_objective"));
  EXPECT_FALSE(document.contains("missed"));
}

// The design that was found is told all the same.
TEST_F(MapOptimize, FailsAsTheEvaluatorDoes) {
  evaluator_.failure = PreconditionFailed("RIGID_MOTION", "the shelf is free to move", "supports");
  const auto [text, status] = Print({"--minimize", "mass"});
  EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION");
  EXPECT_THAT(text, HasSubstr("objective 16 by the map; 12 of 16"));
  EXPECT_THAT(text, Not(HasSubstr("evaluated")));
}

TEST_F(MapOptimize, TakesNoAnswerForOtherMetrics) {
  evaluator_.told = 1;
  const auto [text, status] = Print({"--minimize", "mass"});
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
}

// An objective may have no value with the metrics as they are.
TEST_F(MapOptimize, NamesAnObjectiveWithoutAValue) {
  const auto [text, status] = Print({"--minimize", "mass / (mean_von_mises - 3.25e6)"});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("divides by zero"));
}

}  // namespace
}  // namespace mortise::cli
