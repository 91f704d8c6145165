// Mass, inertia, shadows, standing and floating by name, of bodies whose values are known.
#include "common/design/geometry_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/common/mesh/box_assembly.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::simulator {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

SolidPart PartOf(mesh::SurfaceMesh surface, double density) {
  const double volume = mesh::ComputeMassProperties(surface).volume;
  return {std::move(surface), volume, density};
}

SolidPart Box(const Vector3d& low, const Vector3d& high, double density) {
  return PartOf(mesh::BoxSurface(low, high), density);
}

std::map<std::string, double> AllOf(GeometryMetrics metrics) {
  std::map<std::string, double> values;
  for (const MetricDescription& metric : GeometryMetrics::Offered()) {
    const auto value = metrics.Value(metric.name);
    EXPECT_TRUE(value.ok()) << metric.name << ": " << value.status();
    values[metric.name] = value.value_or(NAN);
  }
  return values;
}

TEST(GeometryMetrics, OfABox) {
  const Vector3d size(0.4, 0.6, 0.2);
  auto metrics = AllOf(GeometryMetrics({Box({1, 2, 3}, Vector3d(1, 2, 3) + size, 500)}));
  const double volume = size.prod(), mass = 500 * volume;
  EXPECT_NEAR(metrics["volume"], volume, 1e-12);
  EXPECT_NEAR(metrics["mass"], mass, 1e-9);
  EXPECT_NEAR(metrics["center_of_mass_x"], 1.2, 1e-12);
  EXPECT_NEAR(metrics["center_of_mass_y"], 2.3, 1e-12);
  EXPECT_NEAR(metrics["center_of_mass_z"], 3.1, 1e-12);
  EXPECT_NEAR(metrics["inertia_xx"], mass * (0.36 + 0.04) / 12, 1e-10);
  EXPECT_NEAR(metrics["inertia_yy"], mass * (0.16 + 0.04) / 12, 1e-10);
  EXPECT_NEAR(metrics["inertia_zz"], mass * (0.16 + 0.36) / 12, 1e-10);
  EXPECT_NEAR(metrics["inertia_xy"], 0, 1e-10);
  EXPECT_NEAR(metrics["projected_area_x"], 0.6 * 0.2, 1e-9);
  EXPECT_NEAR(metrics["projected_area_y"], 0.4 * 0.2, 1e-9);
  EXPECT_NEAR(metrics["projected_area_z"], 0.4 * 0.6, 1e-9);
  EXPECT_NEAR(metrics["drag"], 0.5 * 1.225 * 100 * 0.6 * 0.2, 1e-6);
  EXPECT_NEAR(metrics["toppling_margin"], 0.2, 1e-12);
  EXPECT_NEAR(metrics["toppling_angle"], std::atan(0.2 / 0.1), 1e-12);
  EXPECT_NEAR(metrics["displaced_volume"], volume / 2, 1e-12);
  EXPECT_NEAR(metrics["draught"], 0.1, 1e-10);
  EXPECT_NEAR(metrics["freeboard"], 0.1, 1e-10);
  EXPECT_NEAR(metrics["metacentric_height"], 0.05 + 0.16 / (12 * 0.1) - 0.1, 1e-9);
}

TEST(GeometryMetrics, OfACylinder) {
  const double radius = 0.1, height = 0.3, density = 700;
  auto metrics = AllOf(GeometryMetrics({PartOf(mesh::Cylinder(radius, height, 256), density)}));
  const double mass = density * kPi * radius * radius * height;
  EXPECT_NEAR(metrics["mass"], mass, 2e-4 * mass);
  EXPECT_NEAR(metrics["inertia_zz"], mass * radius * radius / 2, 4e-4 * metrics["inertia_zz"]);
  EXPECT_NEAR(metrics["inertia_xx"], mass * (3 * radius * radius + height * height) / 12,
              4e-4 * metrics["inertia_xx"]);
  EXPECT_NEAR(metrics["projected_area_x"], 2 * radius * height, 1e-5);
  EXPECT_NEAR(metrics["projected_area_z"], kPi * radius * radius, 2e-4 * kPi * radius * radius);
  EXPECT_NEAR(metrics["toppling_margin"], radius, 1e-4 * radius);
}

// The parallel axes' theorem, with parts of different density.
TEST(GeometryMetrics, OfPartsOfDifferentDensity) {
  auto metrics = AllOf(GeometryMetrics(
      {Box({-1.5, -0.5, 0}, {-0.5, 0.5, 1}, 100), Box({0.5, 1.5, 0}, {1.5, 2.5, 1}, 300)}));
  EXPECT_NEAR(metrics["mass"], 400, 1e-9);
  EXPECT_NEAR(metrics["center_of_mass_x"], 0.5, 1e-12);
  EXPECT_NEAR(metrics["center_of_mass_y"], 1.5, 1e-12);
  // Reduced mass 75 kg at a distance of (2, 2), and both cubes' own.
  EXPECT_NEAR(metrics["inertia_zz"], 400.0 / 6 + 75 * 8, 1e-9);
  EXPECT_NEAR(metrics["inertia_xy"], -75 * 4, 1e-9);
  EXPECT_NEAR(metrics["inertia_xx"], 400.0 / 6 + 75 * 4, 1e-9);
}

// A round part weighs what its exact volume does, though its triangles enclose less.
TEST(GeometryMetrics, MassIsThatOfTheExactVolume) {
  const double exact = kPi * 0.01 * 0.3;
  GeometryMetrics metrics({SolidPart{mesh::Cylinder(0.1, 0.3, 12), exact, 700}});
  EXPECT_NEAR(*metrics.Value("volume"), exact, 1e-15);
  EXPECT_NEAR(*metrics.Value("mass"), 700 * exact, 1e-12);
  EXPECT_NEAR(*metrics.Value("displaced_volume"), 0.7 * exact, 1e-12);
}

TEST(GeometryMetrics, FollowTheWindAndTheWater) {
  const SolidPart box = Box(Vector3d::Zero(), {1, 2, 3}, 600);
  Surroundings sea;
  sea.wind = {0, 20, 0};
  sea.drag_coefficient = 1.2;
  sea.water_density = 1025;
  GeometryMetrics metrics({box}, sea);
  EXPECT_NEAR(*metrics.Value("drag"), 0.5 * 1.225 * 400 * 1.2 * 3, 1e-5);
  EXPECT_NEAR(*metrics.Value("draught"), 3 * 600.0 / 1025, 1e-9);
}

TEST(GeometryMetrics, AreNamedOnceAndRefuseOthers) {
  std::set<std::string> names;
  for (const MetricDescription& metric : GeometryMetrics::Offered()) {
    EXPECT_TRUE(names.insert(metric.name).second) << metric.name;
    EXPECT_FALSE(metric.unit.empty()) << metric.name;
    EXPECT_FALSE(metric.description.empty()) << metric.name;
  }
  GeometryMetrics metrics({Box(Vector3d::Zero(), Vector3d::Ones(), 7850)});
  EXPECT_EQ(DetailOf(metrics.Value("draught").status()).reason, "SINKS");
  EXPECT_EQ(metrics.Value("beauty").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(metrics.Value("inertia_zx").status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::simulator
