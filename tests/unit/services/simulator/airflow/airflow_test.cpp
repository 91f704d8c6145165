// The flow of air around a body: what is known of balls and cubes, and how requests end.
#include "services/simulator/airflow/airflow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <thread>

#include "common/base/errors.h"
#include "tests/support/environment.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/services/simulator/airflow/bodies_in_air.h"

namespace mortise::simulator {
namespace {

using parametric::Airflow;
using testing::Environment;

double DynamicPressure(const Airflow& airflow) {
  return 0.5 * airflow.air.Density() * airflow.wind.squaredNorm();
}

// The pressure where the surface looks the nearest to `degrees` away from the oncoming air, in
// dynamic pressures.
double CoefficientAt(double degrees, const AirflowSolution& solution, const Airflow& airflow) {
  const auto cosine = [&](Eigen::Index vertex) {
    return -airflow.wind.normalized().dot(solution.surface.vertices.col(vertex).normalized());
  };
  const double wanted = std::cos(degrees * std::numbers::pi / 180);
  Eigen::Index nearest = 0;
  for (Eigen::Index v = 1; v < solution.pressure.size(); ++v) {
    if (std::abs(cosine(v) - wanted) < std::abs(cosine(nearest) - wanted)) nearest = v;
  }
  return solution.pressure[nearest] / DynamicPressure(airflow);
}

TEST(Airflow, StagnatesInFrontOfABall) {
  Airflow airflow{.cells = 8000};
  const auto flow = SolveAirflow(Ball(0.1), airflow);
  ASSERT_TRUE(flow.ok()) << flow.status();
  // Bernoulli in front; behind it the front of a ball is as in potential flow, 1 - 9/4 sin².
  EXPECT_NEAR(CoefficientAt(0, *flow, airflow), 1, 0.05);
  EXPECT_NEAR(CoefficientAt(15, *flow, airflow), 0.849, 0.05);
  EXPECT_NEAR(CoefficientAt(30, *flow, airflow), 0.4375, 0.1);
  EXPECT_LT(CoefficientAt(90, *flow, airflow), -0.8);
  EXPECT_GE(flow->minimum_pressure, -1.6 * DynamicPressure(airflow));
}

TEST(Airflow, CompressesWhereItStagnates) {
  constexpr double kMach = 0.6;
  Airflow airflow{.cells = 8000};
  airflow.wind = {0, 0, -kMach * airflow.air.SpeedOfSound()};
  const auto flow = SolveAirflow(Ball(0.1), airflow);
  ASSERT_TRUE(flow.ok()) << flow.status();
  // Isentropic, of a gas of two atoms.
  const double coefficient = (std::pow(1 + 0.2 * kMach * kMach, 3.5) - 1) / (0.7 * kMach * kMach);
  EXPECT_NEAR(CoefficientAt(0, *flow, airflow), coefficient, 0.05);
}

TEST(Airflow, DragsACubeAsMeasured) {
  // 1.05 in Hoerner's Fluid-Dynamic Drag (1965), chapter 3, for all Reynolds numbers above 1e4.
  Airflow airflow{.wind = {0, 15, 0}, .cells = 16'000};
  const mesh::SurfaceMesh cube = Brick({0.1, 0.1, 0.1});
  const auto flow = SolveAirflow(cube, airflow);
  ASSERT_TRUE(flow.ok()) << flow.status();
  const Eigen::Vector3d coefficient = flow->force / (DynamicPressure(airflow) * 0.01);
  EXPECT_NEAR(coefficient.y(), 1.05, 0.15);
  EXPECT_NEAR(coefficient.x(), 0, 0.03);
  EXPECT_NEAR(coefficient.z(), 0, 0.03);
  EXPECT_LT(flow->force_swing, 0.01 * flow->force.norm());
  EXPECT_GT(flow->cells, 8'000);
  EXPECT_LT(flow->cells, 32'000);

  // Pressures told on the surface add up to the force, but for friction.
  Eigen::Vector3d pressed = Eigen::Vector3d::Zero();
  const auto& [vertices, triangles] = flow->surface;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = vertices.col(triangles(0, t));
    const Eigen::Vector3d b = vertices.col(triangles(1, t));
    const Eigen::Vector3d c = vertices.col(triangles(2, t));
    const double mean = (flow->pressure[triangles(0, t)] + flow->pressure[triangles(1, t)] +
                         flow->pressure[triangles(2, t)]) /
                        3;
    pressed -= 0.5 * mean * (b - a).cross(c - a);
  }
  EXPECT_LT((pressed + flow->friction - flow->force).norm(), 0.03 * flow->force.norm());
}

TEST(Airflow, TurnsWithTheWind) {
  // A brick and the wind, and both a quarter turn on.
  Airflow airflow{.wind = {-12, 5, 0}, .cells = 3000};
  const auto first = SolveAirflow(Brick({0.2, 0.1, 0.05}), airflow);
  ASSERT_TRUE(first.ok()) << first.status();
  airflow.wind = {-5, -12, 0};
  const auto turned = SolveAirflow(Brick({0.1, 0.2, 0.05}), airflow);
  ASSERT_TRUE(turned.ok()) << turned.status();
  const Eigen::Vector3d expected(-first->force.y(), first->force.x(), first->force.z());
  EXPECT_LT((turned->force - expected).norm(), 0.01 * expected.norm())
      << turned->force.transpose() << " not " << expected.transpose();
}

TEST(Airflow, IsTheSameAtTheSameReynoldsNumber) {
  Airflow airflow{.wind = {20, 0, 0}, .cells = 3000};
  const auto small = SolveAirflow(Brick({0.1, 0.1, 0.05}), airflow);
  ASSERT_TRUE(small.ok()) << small.status();
  const auto again = SolveAirflow(Brick({0.1, 0.1, 0.05}), airflow);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->force, small->force);
  EXPECT_EQ(again->pressure, small->pressure);
  airflow.wind = {2, 0, 0};
  const auto large = SolveAirflow(Brick({1, 1, 0.5}), airflow);
  ASSERT_TRUE(large.ok()) << large.status();
  // Area times dynamic pressure are the same; only compressibility is not.
  EXPECT_NEAR(large->force.x(), small->force.x(), 0.01 * small->force.x());
}

TEST(Airflow, AsksForMoreCellsWhereNoneMeetsAThinRod) {
  const absl::Status few = SolveAirflow(Brick({0.004, 1, 0.004}), {.cells = 2000}).status();
  EXPECT_EQ(few.code(), absl::StatusCode::kFailedPrecondition) << few;
  EXPECT_EQ(DetailOf(few).reason, "TOO_FEW_CELLS");
  EXPECT_NE(few.message().find("more than 2000"), absl::string_view::npos) << few;
}

TEST(Airflow, AirIsAsInTheStandardAtmosphere) {
  const parametric::Air sea_level;
  EXPECT_NEAR(sea_level.Density(), 1.225, 1e-3);
  EXPECT_NEAR(sea_level.Viscosity(), 1.789e-5, 1e-8);
  EXPECT_NEAR(sea_level.SpeedOfSound(), 340.3, 0.5);
  const parametric::Air at_11_km{.temperature = 216.65, .pressure = 22632};
  EXPECT_NEAR(at_11_km.Density(), 0.3639, 1e-3);
  EXPECT_NEAR(at_11_km.SpeedOfSound(), 295.1, 0.5);
}

TEST(Airflow, RefusesWhatItCannotCompute) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Airflow airflow;
  airflow.wind = {nan, 0, 0};
  airflow.air = {.temperature = 20, .pressure = 0};
  airflow.cells = 3;
  const absl::Status faults = parametric::CheckAirflow(airflow);
  EXPECT_EQ(faults.code(), absl::StatusCode::kInvalidArgument);
  for (const char* const field : {"wind", "temperature", "pressure", "cells"}) {
    EXPECT_NE(faults.message().find(field), absl::string_view::npos) << field << ": " << faults;
  }
  EXPECT_EQ(DetailOf(parametric::CheckAirflow({.wind = {0.5, 0, 0}})).field, "wind");
  // In cold air sound is slower.
  EXPECT_TRUE(parametric::CheckAirflow({.wind = {230, 0, 0}}).ok());
  EXPECT_EQ(
      DetailOf(parametric::CheckAirflow({.wind = {230, 0, 0}, .air = {.temperature = 200}})).field,
      "wind");

  const absl::Status large =
      SolveAirflow(Brick({1, 1, 1}), {.cells = 5'000'000}, {.memory_limit = 1e9}).status();
  EXPECT_EQ(large.code(), absl::StatusCode::kResourceExhausted) << large;
}

TEST(Airflow, SaysWhereOpenFoamIsNotInstalled) {
  const testing::TemporaryFolder empty;
  const Environment path("PATH", empty.path());
  const absl::Status status = SolveAirflow(Brick({1, 1, 1}), {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
  EXPECT_EQ(DetailOf(status).reason, "NO_OPENFOAM");
  EXPECT_NE(status.message().find("install Debian's package 'openfoam'"), absl::string_view::npos);
}

TEST(Airflow, EndsWhenNobodyWantsItAndLeavesNothing) {
  const testing::TemporaryFolder folder;
  const Environment temporary("TMPDIR", folder.path());
  for (const std::string stage : {"air: cells", "air: flow"}) {
    StageProgress progress;
    std::stop_source stop;
    std::atomic<bool> ended = false;
    std::thread watcher([&] {
      while (!ended && !progress.state().stage.starts_with(stage)) std::this_thread::yield();
      stop.request_stop();
    });
    const absl::Status status = SolveAirflow(Brick({1, 1, 1}), {.cells = 2000},
                                             {.progress = &progress, .stop = stop.get_token()})
                                    .status();
    ended = true;
    watcher.join();
    EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << stage << ": " << status;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << stage;
  }
}

}  // namespace
}  // namespace mortise::simulator
