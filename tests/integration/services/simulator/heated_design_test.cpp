// Designs with heat and load cases, from the collection to temperatures and stresses, through
// catalog, simulator and worker as processes.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/analysed_design_test.h"

namespace mortise::simulator {
namespace {

using testing::Call;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

// A board held at one end and guided at the other, under its weight in every load case, and wind or
// snow besides.
constexpr char kBoard[] =
    "name: 'templates/board' title: 'Board' "
    "parameters { name: 'length' unit: 'm' minimum: 0.4 maximum: 1.2 default_value: 0.8 } "
    "parts { name: 'board' item: 'items/spruce-planed-2400' length_axis: X thickness_axis: Z "
    "box { x { from: '0' to: 'length' } y { from: '0' to: '0.1' } z { from: '0' to: '0.02' } } } "
    "boundary_conditions { name: 'left' kind: FIXED part: 'board' face: 'x_min' } "
    "boundary_conditions { name: 'right' kind: SYMMETRIC part: 'board' face: 'x_max' } "
    "boundary_conditions { name: 'weight' kind: GRAVITY components: '0' components: '0' "
    "components: '-9.81' } "
    "boundary_conditions { name: 'gust' kind: PRESSURE part: 'board' face: 'y_min' "
    "components: '500' load_case: 'wind' } "
    "boundary_conditions { name: 'drift' kind: PRESSURE part: 'board' face: 'z_max' "
    "components: '1500' load_case: 'snow' }";

using HeatedDesignTest = AnalysedDesignTest;

// What the shoes rub into the drum, its outside gives to the air.
TEST_F(HeatedDesignTest, TheBrakeDrumGivesItsHeatToTheAir) {
  const auto analysis = Analyze("templates/drum-brake", 0.008);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_THAT(FilesOf(*analysis),
              UnorderedElementsAre("analysis.vtu", "stress.png", "heat.vtu", "heat.png"));
  EXPECT_THAT(Download(*analysis, "heat.vtu"), HasSubstr("heat flux"));
  EXPECT_EQ(Download(*analysis, "heat.png").substr(1, 3), "PNG");
  EXPECT_EQ(Download(*analysis, "stress.png").substr(1, 3), "PNG");
  EXPECT_THAT(Download(*analysis, "analysis.vtu"), HasSubstr("\"temperature\""));
  // 20 kW/m² on the inner wall, 2 π 0.1 m by 39 mm between its rounding at the web and the front.
  const v1::HeatResult& heat = analysis->heat();
  EXPECT_NEAR(heat.supplied(), 20e3 * 2 * M_PI * 0.1 * 0.039, 0.005 * heat.supplied());
  ASSERT_EQ(heat.convected_size(), 1);
  EXPECT_NEAR(heat.convected(0), heat.supplied(), 1e-6 * heat.supplied());
  EXPECT_EQ(heat.through_temperatures(), 0);
  auto metrics = MetricsOf(*analysis);
  EXPECT_EQ(metrics.at("max_temperature"), heat.maximum());
  EXPECT_NEAR(metrics.at("heat_dissipation"), heat.supplied(), 1e-6 * heat.supplied());
  // Were the 0.083 m² outside alike warm, it would be by 490 W / (80 W/(m² K) 0.083 m²) = 74 K.
  EXPECT_NEAR(metrics.at("mean_temperature"), 293.15 + 74, 8);
  EXPECT_GT(metrics.at("max_temperature"), 293.15 + 74);
  EXPECT_LT(metrics.at("max_temperature"), 293.15 + 100);
  EXPECT_GT(metrics.at("min_temperature"), 293.15);
  ASSERT_EQ(analysis->cases_size(), 1);
  EXPECT_EQ(analysis->cases(0).name(), "loads");
  for (const char* metric : {"max_von_mises", "mean_von_mises", "rms_von_mises", "von_mises_p99",
                             "von_mises_integral"}) {
    EXPECT_EQ(MetricsOf(analysis->cases(0)).at(metric), metrics.at(metric)) << metric;
  }
  EXPECT_LT(metrics.at("mean_von_mises"), metrics.at("rms_von_mises"));
  EXPECT_LT(metrics.at("rms_von_mises"), metrics.at("von_mises_p99"));
  EXPECT_LT(metrics.at("von_mises_p99"), metrics.at("max_von_mises"));
  EXPECT_NEAR(analysis->total_load().x(), 1500, 1e-6);
  EXPECT_NEAR(analysis->total_load().y(), 900, 1e-6);
}

TEST_F(HeatedDesignTest, HeatIsAskedForLikeAnyMetric) {
  const std::vector<std::string> metrics{"mass", "max_temperature", "heat_dissipation"};
  const auto drums = Evaluate("templates/drum-brake", metrics, {0.2, 0.5, 0.8});
  for (const v1::EvaluationResult& drum : drums) {
    ASSERT_FALSE(drum.has_error()) << drum.error().message();
    ASSERT_EQ(drum.metrics_size(), 3);
    EXPECT_EQ(drum.metrics(1).unit(), "K");
    EXPECT_EQ(drum.metrics(2).unit(), "W");
    EXPECT_GT(drum.metrics(1).value(), 293.15);
  }
  // A thicker rim is heavier.
  EXPECT_LT(drums[0].metrics(0).value(), drums[2].metrics(0).value());
  const auto again = Evaluate("templates/drum-brake", metrics, {0.5});
  EXPECT_TRUE(again[0].cached());
  EXPECT_EQ(again[0].metrics(1).value(), drums[1].metrics(1).value());
  // What has no heat says what to add.
  const auto wrench = Evaluate("templates/wrench", {"max_temperature"}, {0.5});
  const absl::Status status = rpc::FromProto(wrench[0].error());
  EXPECT_EQ(DetailOf(status).reason, "NO_HEAT");
  EXPECT_THAT(std::string(status.message()), HasSubstr("HEAT_FLUX"));
}

TEST_F(HeatedDesignTest, EveryLoadCaseIsTold) {
  v1::ImportTemplateRequest request;
  request.set_request_id("board");
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(kBoard, request.mutable_template_()));
  const auto imported = Call(*catalog_, &v1::CatalogService::Stub::ImportTemplate, request);
  ASSERT_TRUE(imported.ok()) << imported.status();
  v1::AnalyzeDesignRequest iterated;
  iterated.set_solver(v1::ITERATIVE);
  const auto analysis = Analyze("templates/board", 0.02, iterated);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  for (const v1::CaseResult& result : analysis->cases()) {
    EXPECT_EQ(result.solver().kind(), v1::ITERATIVE);
    EXPECT_GT(result.solver().iterations(), 0);
  }
  EXPECT_THAT(FilesOf(*analysis),
              UnorderedElementsAre("1-wind.vtu", "1-wind.png", "2-snow.vtu", "2-snow.png"));
  EXPECT_EQ(Download(*analysis, "2-snow.png").substr(1, 3), "PNG");
  ASSERT_EQ(analysis->cases_size(), 2);
  EXPECT_FALSE(analysis->has_heat());
  EXPECT_FALSE(analysis->has_total_load());
  const auto &wind = analysis->cases(0), &snow = analysis->cases(1);
  EXPECT_EQ(wind.name(), "wind");
  EXPECT_EQ(snow.name(), "snow");
  const double weight = MetricsOf(*analysis).at("mass") * 9.81;
  EXPECT_NEAR(wind.total_load().z(), -weight, 1e-6 * weight);
  EXPECT_NEAR(wind.total_load().y(), 500 * 0.8 * 0.02, 1e-6);
  EXPECT_NEAR(snow.total_load().z(), -weight - 1500 * 0.8 * 0.1, 1e-6);
  ASSERT_EQ(snow.reactions_size(), 2);
  ASSERT_EQ(snow.parts_size(), 1);
  EXPECT_EQ(snow.parts(0).name(), "board");
  for (const char* metric : {"max_displacement", "max_von_mises", "compliance", "strain_energy"}) {
    EXPECT_EQ(MetricsOf(*analysis).at(metric),
              std::max(MetricsOf(wind).at(metric), MetricsOf(snow).at(metric)))
        << metric;
  }
}

// A worker beside which Gmsh is not installed says so, and the next meshes what is round.
TEST_F(HeatedDesignTest, AnotherWorkerMayHaveGmsh) {
  worker_->End(SIGTERM);
  worker_ = std::make_unique<testing::ChildProcess>(WorkerCommand({"/usr/bin/env", "PATH=/none"}));
  const auto without = Evaluate("templates/drum-brake", {"max_temperature"}, {0.25});
  const absl::Status failure = rpc::FromProto(without[0].error());
  EXPECT_EQ(DetailOf(failure).reason, "NO_GMSH") << failure;
  EXPECT_THAT(std::string(failure.message()), HasSubstr("install Debian's package 'gmsh'"));
  worker_->End(SIGTERM);
  worker_ = std::make_unique<testing::ChildProcess>(WorkerCommand());
  const auto with = Evaluate("templates/drum-brake", {"max_temperature"}, {0.25});
  ASSERT_FALSE(with[0].has_error()) << with[0].error().message();
  EXPECT_FALSE(with[0].cached());
  EXPECT_GT(with[0].metrics(0).value(), 300);
}

}  // namespace
}  // namespace mortise::simulator
