// Every assembly that ships can be analysed: its parts touch, and none is within another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/cad/assembly_surface.h"
#include "common/cad/cylinder.h"
#include "common/mesh/surface_check.h"
#include "common/parametric/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

class ShippedSurfacesTest : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedSurfacesTest, CanBeMeshed) {
  v1::TemplateBundle bundle = templates::ShippedAssembly(GetParam());
  ASSERT_EQ(templates::Complete(bundle, templates::Trial::kDefaults), absl::OkStatus());
  const auto function = templates::Compile(bundle);
  ASSERT_TRUE(function.ok()) << function.status();
  const Eigen::VectorXd parameters = parametric::Defaults((*function)->parameters());
  const auto design = (*function)->Evaluate(parameters);
  ASSERT_TRUE(design.ok()) << design.status();
  const auto model = MakeDesignModel(**function, parameters, *design);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(mesh::CheckAssembly(model->surface), absl::OkStatus());
  const auto crossing = mesh::FindIntersections(model->surface.vertices, model->surface.triangles);
  EXPECT_TRUE(crossing.empty()) << "at " << crossing.front().place.transpose();
}

std::vector<std::string> AssembliesThatShip() {
  std::vector<std::string> names;
  for (const v1::Assembly& assembly : templates::ShippedCollection().assemblies) {
    names.push_back(assembly.name());
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedSurfacesTest, ::testing::ValuesIn(AssembliesThatShip()),
                         [](const auto& assembly) {
                           std::string name = assembly.param.substr(assembly.param.find('/') + 1);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// A slim round bar has few facets, and bends as a round bar does.
TEST(RoundBarTest, BendsAsBeamTheorySays) {
  constexpr double kRadius = 0.015, kLength = 0.45, kForce = 100, kModulus = 12e9, kPoisson = 0.3;
  cad::CylinderShape bar;
  bar.name = "bar";
  bar.radius_u = bar.radius_v = kRadius;
  bar.height = kLength;
  const auto surface = cad::FuseAssembly(std::vector<cad::Solid>{cad::MakeCylinder(bar).value()});
  ASSERT_TRUE(surface.ok()) << surface.status();
  DesignModel model{*surface, {}};
  model.analysis.materials.push_back({"wood", 700, kModulus, kPoisson, 60e6});
  model.analysis.supports.push_back({{0, "base"}});
  model.analysis.forces.push_back({{0, "cap"}, {kForce, 0, 0}});
  const auto analysis = AnalyzeDesign(model, {"max_displacement"}, false);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double second_moment = std::numbers::pi / 4 * std::pow(kRadius, 4);
  const double area = std::numbers::pi * kRadius * kRadius;
  const double shear_modulus = kModulus / 2 / (1 + kPoisson);
  const double factor = 6 * (1 + kPoisson) / (7 + 6 * kPoisson);  // Timoshenko's, of a circle
  const double exact = kForce * std::pow(kLength, 3) / 3 / kModulus / second_moment +
                       kForce * kLength / factor / area / shear_modulus;
  EXPECT_NEAR(analysis->metrics.at(0).value, exact, 0.01 * exact);
}

}  // namespace
}  // namespace mortise::simulator
