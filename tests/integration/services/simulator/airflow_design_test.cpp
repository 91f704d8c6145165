// The air around designs, from the collection to pressures on them, through catalog, simulator and
// worker as processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "tests/integration/services/simulator/analysed_design_test.h"

namespace mortise::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

using AirflowDesignTest = AnalysedDesignTest;

constexpr double kDynamicPressure = 61.25;  // Pa, of air at sea level at 10 m/s

v1::EvaluateBatchRequest InWind(double x, double y) {
  v1::EvaluateBatchRequest request;
  request.mutable_airflow()->mutable_wind()->set_x(x);
  request.mutable_airflow()->mutable_wind()->set_y(y);
  request.mutable_airflow()->set_cells(2500);
  return request;
}

TEST_F(AirflowDesignTest, ThePlaneIsPressedByTheAir) {
  v1::AnalyzeDesignRequest asked;
  asked.mutable_airflow()->mutable_wind()->set_x(-10);
  asked.mutable_airflow()->set_cells(6000);
  const auto analysis = Analyze("templates/plane", 0.01, asked);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_THAT(FilesOf(*analysis),
              UnorderedElementsAre("analysis.vtu", "stress.png", "airflow.vtu", "airflow.png"));
  EXPECT_NE(Download(*analysis, "airflow.vtu").find("\"pressure (Pa)\""), std::string::npos);
  EXPECT_EQ(Download(*analysis, "airflow.png").substr(1, 3), "PNG");
  const v1::AirflowResult& airflow = analysis->airflow();
  EXPECT_EQ(airflow.wind().x(), -10);
  EXPECT_GT(airflow.cells(), 3000);
  EXPECT_GT(airflow.iterations(), 0);
  EXPECT_LT(airflow.force_swing(), 0.05 * -airflow.force().x());
  auto metrics = MetricsOf(*analysis);
  EXPECT_NEAR(metrics.at("airflow_drag"), -airflow.force().x(), 1e-12);
  EXPECT_EQ(metrics.at("airflow_force_z"), airflow.force().z());
  EXPECT_EQ(metrics.at("max_air_pressure"), airflow.maximum_pressure());
  // Less than a plate across the wind of the plane's silhouette, more than a fifth of it.
  EXPECT_GT(metrics.at("airflow_drag"), 0.2 * kDynamicPressure * metrics.at("projected_area_x"));
  EXPECT_LT(metrics.at("airflow_drag"), 1.2 * kDynamicPressure * metrics.at("projected_area_x"));
  EXPECT_LT(airflow.maximum_pressure(), 1.1 * kDynamicPressure);
  EXPECT_GT(airflow.maximum_pressure(), 0.4 * kDynamicPressure);
  EXPECT_LT(airflow.minimum_pressure(), -0.2 * kDynamicPressure);
}

TEST_F(AirflowDesignTest, AirIsAskedForLikeAnyMetric) {
  const std::vector<std::string> metrics{"airflow_drag", "airflow_force_y", "mass"};
  const auto front = Evaluate("templates/table", metrics, {0.5}, InWind(-10, 0));
  ASSERT_FALSE(front[0].has_error()) << front[0].error().message();
  ASSERT_EQ(front[0].metrics_size(), 3);
  EXPECT_EQ(front[0].metrics(0).unit(), "N");
  EXPECT_GT(front[0].metrics(0).value(), 0);
  EXPECT_FALSE(front[0].cached());
  EXPECT_TRUE(Evaluate("templates/table", metrics, {0.5}, InWind(-10, 0))[0].cached());
  v1::EvaluateBatchRequest with_field = InWind(0, 10);
  with_field.mutable_design_fields()->set_geometry(v1::SURFACE);
  with_field.mutable_design_fields()->add_fields("air_pressure");
  const auto side = Evaluate("templates/table", metrics, {0.5}, with_field);
  ASSERT_FALSE(side[0].has_error()) << side[0].error().message();
  EXPECT_FALSE(side[0].cached());
  EXPECT_NEAR(side[0].metrics(1).value(), side[0].metrics(0).value(), 1e-9);
  EXPECT_EQ(side[0].metrics(2).value(), front[0].metrics(2).value());
  EXPECT_THAT(side[0].design_fields().fields(), ElementsAre("air_pressure"));
  EXPECT_GT(side[0].design_fields().nodes(), 500) << "of a mesh, also within faces";
}

TEST_F(AirflowDesignTest, RefusesAirThatCannotBeComputed) {
  v1::AnalyzeDesignRequest asked;
  asked.mutable_airflow()->mutable_wind()->set_x(300);
  asked.mutable_airflow()->set_cells(3);
  const absl::Status refused = Analyze("templates/plane", 0.01, asked).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("airflow.wind"));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("airflow.cells"));
}

// A worker beside which nothing is installed says so, and the next computes it.
TEST_F(AirflowDesignTest, AnotherWorkerMayHaveOpenFoam) {
  worker_->End(SIGTERM);
  worker_ = std::make_unique<testing::ChildProcess>(WorkerCommand({"/usr/bin/env", "PATH=/none"}));
  const auto without = Evaluate("templates/table", {"airflow_drag"}, {0.25}, InWind(-10, 0));
  const absl::Status failure = rpc::FromProto(without[0].error());
  EXPECT_EQ(DetailOf(failure).reason, "NO_OPENFOAM") << failure;
  EXPECT_THAT(std::string(failure.message()), HasSubstr("install Debian's package 'openfoam'"));
  worker_->End(SIGTERM);
  worker_ = std::make_unique<testing::ChildProcess>(WorkerCommand());
  const auto with = Evaluate("templates/table", {"airflow_drag"}, {0.25}, InWind(-10, 0));
  EXPECT_FALSE(with[0].has_error()) << with[0].error().message();
}

}  // namespace
}  // namespace mortise::simulator
