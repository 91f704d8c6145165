// Every assembly that ships can be analysed: its parts touch, and none is within another.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>

#include "absl/strings/substitute.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/cylinder.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/design/parameter_values.h"
#include "common/fields/design_fields.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/element_budget.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/templates/template_codec.h"
#include "services/simulator/analysis/design_fields.h"
#include "services/simulator/worker/template_model.h"
#include "tests/support/replaced_program.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

// The model of a template at its defaults.
absl::StatusOr<DesignModel> ModelOf(v1::TemplateBundle bundle) {
  MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults));
  MORTISE_ASSIGN_OR_RETURN(const auto function, templates::Compile(bundle));
  const Eigen::VectorXd parameters = parametric::Defaults(function->parameters());
  MORTISE_ASSIGN_OR_RETURN(const auto design, function->Evaluate(parameters));
  return MakeDesignModel(*function, parameters, design);
}

class ShippedSurfacesTest : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedSurfacesTest, CanBeMeshed) {
  const auto model = ModelOf(templates::ShippedAssembly(GetParam()));
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(mesh::CheckAssembly(model->surface), absl::OkStatus());
  const auto crossing = mesh::FindIntersections(model->surface.vertices, model->surface.triangles);
  EXPECT_TRUE(crossing.empty()) << "at " << crossing.front().place.transpose();
  // Its parts and regions have names of their own, however many copies there are.
  const auto shape = CollectFields(*model, DesignAnalysis(), {});
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_EQ(fields::Check(*shape), absl::OkStatus());
  EXPECT_EQ(shape->triangles.cols(), model->surface.triangles.cols());
}

// Its back is 6.5 mm thick, which well-shaped elements take 156,000 for.
TEST(ShippedSurfaces, TheBookshelfIsMeshedWithinTheBudget) {
  const auto model = ModelOf(templates::ShippedAssembly("assemblies/bookshelf"));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto budgeted = mesh::MeshWithinBudget(model->surface, {}, {});
  ASSERT_TRUE(budgeted.ok()) << budgeted.status();
  const auto made = static_cast<double>(budgeted->mesh.tetrahedra.cols());
  EXPECT_LE(made, mesh::kQuadraticBudget);
  EXPECT_GT(made, mesh::kQuadraticBudget / 4.0);
  ASSERT_GT(budgeted->chosen_size, 0.0065);
  EXPECT_FALSE(budgeted->is_beyond);
  const double expected = mesh::EstimateWideElements(model->surface, budgeted->chosen_size);
  EXPECT_GT(made, expected / 2);
  EXPECT_LT(made, expected * 2);
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

TEST(ShippedTetrahedraTest, FillWhatWasDrawnAnew) {
  for (const std::string name : {"assemblies/coat-rack", "assemblies/tool-cart"}) {
    SCOPED_TRACE(name);
    const auto model = ModelOf(templates::ShippedAssembly(name));
    ASSERT_TRUE(model.ok()) << model.status();
    mesh::MeshOptions options;
    options.quadratic = false;
    const auto meshed = mesh::MeshAssembly(model->surface, options);
    ASSERT_TRUE(meshed.ok()) << meshed.status();
    for (std::size_t i = 0; i < model->surface.part_names.size(); ++i) {
      const int part = static_cast<int>(i);
      const double volume =
          mesh::ComputeMassProperties(mesh::PartSurface(model->surface, part)).volume;
      EXPECT_NEAR(mesh::ComputeMassProperties(*meshed, part).volume, volume, 1e-6 * volume);
    }
  }
}

// Six times the volume over the longest edge cubed, of the flattest element.
double LeastThickness(const mesh::TetrahedralMesh& mesh) {
  double least = 1;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    Eigen::Matrix<double, 3, 4> x;
    for (int k = 0; k < 4; ++k) x.col(k) = mesh.nodes.col(mesh.tetrahedra(k, e));
    double longest = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) longest = std::max(longest, (x.col(i) - x.col(j)).norm());
    }
    const Eigen::Vector3d a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
    least = std::min(least, a.cross(b).dot(c) / (longest * longest * longest));
  }
  return least;
}

// Some designs within the ranges of a template's parameters, drawn at random.
class RoundDesignsTest : public ::testing::TestWithParam<std::string> {};

TEST_P(RoundDesignsTest, CanBeMeshedWithFewElements) {
  v1::TemplateBundle bundle = templates::ShippedTemplate(GetParam());
  ASSERT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  const auto function = templates::Compile(bundle);
  ASSERT_TRUE(function.ok()) << function.status();
  std::mt19937_64 random(11);
  for (int i = 0; i < 2; ++i) {
    SCOPED_TRACE(i);
    Eigen::VectorXd q((*function)->parameters().size());
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const parametric::Parameter& range = (*function)->parameters()[static_cast<std::size_t>(k)];
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      q[k] = range.minimum + share * (range.maximum - range.minimum);
    }
    const auto design = (*function)->Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    const auto model = MakeDesignModel(**function, q, *design);
    ASSERT_TRUE(model.ok()) << model.status();
    const auto meshed = mesh::MeshAssembly(model->surface, {.quadratic = false});
    ASSERT_TRUE(meshed.ok()) << meshed.status();
    EXPECT_LT(meshed->tetrahedra.cols(), 80'000) << "of the kernel's needles 130,000 to 170,000";
    EXPECT_GT(LeastThickness(*meshed), 1e-9);
    const double volume = model->parts[0].volume;
    EXPECT_NEAR(mesh::ComputeMassProperties(*meshed, 0).volume, volume, 0.005 * volume);
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, RoundDesignsTest,
                         ::testing::Values("templates/chair", "templates/lamp", "templates/wrench",
                                           "templates/plane"),
                         [](const auto& design) {
                           return design.param.substr(design.param.find('/') + 1);
                         });

// Where Gmsh fails there are the kernel's needles, over which TetGen crashes: seven beams on a long
// stem.
TEST(ShippedTetrahedraTest, FillALampThatTheMesherFailsOver) {
  const testing::ReplacedProgram gmsh("gmsh", "exit 1");
  const auto model = ModelOf(templates::ShippedTemplate("templates/lamp"));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto meshed = mesh::MeshAssembly(model->surface, {.quadratic = false});
  ASSERT_TRUE(meshed.ok()) << meshed.status();
  EXPECT_GT(LeastThickness(*meshed), 1e-9);
  const double volume = mesh::ComputeMassProperties(mesh::PartSurface(model->surface, 0)).volume;
  EXPECT_NEAR(mesh::ComputeMassProperties(*meshed, 0).volume, volume, 0.02 * volume);
  // Faces keep their names, on which conditions act.
  EXPECT_FALSE(TrianglesOn(*meshed, {0, "stand.section.sole"}, true).empty());
}

// TetGen makes an element without volume between four points in a plane.
TEST(ShippedTetrahedraTest, HaveVolumesOnceTheSizeIsChanged) {
  const testing::ReplacedProgram gmsh("gmsh", "exit 1");
  v1::TemplateBundle bundle = templates::ShippedTemplate("templates/wrench");
  ASSERT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  const auto function = templates::Compile(bundle);
  ASSERT_TRUE(function.ok()) << function.status();
  Eigen::VectorXd q = parametric::Defaults((*function)->parameters());
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    q[k] += 0.04 * ((*function)->parameters()[static_cast<std::size_t>(k)].maximum - q[k]);
  }
  const auto design = (*function)->Evaluate(q);
  ASSERT_TRUE(design.ok()) << design.status();
  const auto model = MakeDesignModel(**function, q, *design);
  ASSERT_TRUE(model.ok()) << model.status();
  const auto meshed =
      mesh::MeshAssembly(model->surface, {.element_size = 0.004, .quadratic = false});
  ASSERT_TRUE(meshed.ok()) << meshed.status();
  EXPECT_GT(LeastThickness(*meshed), 1e-9);
}

// The drawings that ship, but for their screws.
TEST(ShippedDrawingsTest, KeepTheirVolumes) {
  for (const std::string name : {"garden_seat.step", "wall_shelf.step"}) {
    SCOPED_TRACE(name);
    const char* const sources = std::getenv("MORTISE_SOURCE_DIR");
    const auto bytes = ReadFile(std::filesystem::path(sources == nullptr ? "." : sources) /
                                "collection/drawings" / name);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto drawing = cad::ReadStep(*bytes);
    ASSERT_TRUE(drawing.ok()) << drawing.status();
    std::vector<cad::Solid> solids;
    for (const cad::StepPart& part : drawing->parts) {
      if (part.name.starts_with("screw")) continue;
      const Eigen::Vector3d size = part.maximum - part.minimum;
      mesh::PartShape box;
      box.name = part.name;
      box.outline.resize(2, 4);
      box.outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
      box.height = size.z();
      box.face_names = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
      const auto solid =
          part.shape < 0 ? cad::Solid::FromPart(box)
                         : cad::SolidOfShape(drawing->shapes[static_cast<std::size_t>(part.shape)],
                                             size, part.name);
      ASSERT_TRUE(solid.ok()) << solid.status();
      solids.push_back(cad::MovedSolid(*solid, part.minimum));
    }
    const auto surface = cad::FuseAssembly(solids);
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_EQ(mesh::CheckAssembly(*surface), absl::OkStatus());
    EXPECT_TRUE(mesh::FindIntersections(surface->vertices, surface->triangles).empty());
    EXPECT_LT(surface->triangles.cols(), 30'000);
    for (std::size_t i = 0; i < solids.size(); ++i) {
      const double volume =
          mesh::ComputeMassProperties(mesh::PartSurface(*surface, static_cast<int>(i))).volume;
      EXPECT_NEAR(volume, solids[i].Volume(), 1e-3 * volume) << solids[i].name();
    }
  }
}

// A slim round bar along z, clamped at its base and pushed along x at its other end.
struct RoundBarTest : ::testing::Test {
  static constexpr double kRadius = 0.015, kLength = 0.45, kForce = 100, kModulus = 12e9;
  static constexpr double kPoisson = 0.3;

  void SetUp() override {
    cad::CylinderShape bar;
    bar.name = "bar";
    bar.radius_u = bar.radius_v = kRadius;
    bar.height = kLength;
    const auto surface = cad::FuseAssembly(std::vector<cad::Solid>{cad::MakeCylinder(bar).value()});
    ASSERT_TRUE(surface.ok()) << surface.status();
    model.surface = *surface;
    model.analysis.materials.push_back({"wood", 700, kModulus, kPoisson, 60e6});
    model.analysis.supports.push_back({{0, "base"}});
    model.analysis.forces.push_back({{0, "cap"}, {kForce, 0, 0}});
  }

  const double second_moment = std::numbers::pi / 4 * std::pow(kRadius, 4);
  DesignModel model;
};

TEST_F(RoundBarTest, BendsAsBeamTheorySays) {
  const auto analysis = AnalyzeDesign(model, {"max_displacement"}, false);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double area = std::numbers::pi * kRadius * kRadius;
  const double shear_modulus = kModulus / 2 / (1 + kPoisson);
  const double factor = 6 * (1 + kPoisson) / (7 + 6 * kPoisson);  // Timoshenko's, of a circle
  const double exact = kForce * std::pow(kLength, 3) / 3 / kModulus / second_moment +
                       kForce * kLength / factor / area / shear_modulus;
  EXPECT_NEAR(analysis->metrics.at(0).value, exact, 0.01 * exact);
}

TEST_F(RoundBarTest, HasTheStressesOfBeamTheoryAwayFromItsEnds) {
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.008;
  const auto analysis = AnalyzeDesign(model, {"max_von_mises"}, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const Eigen::Matrix3Xd& nodes = analysis->mesh->nodes;
  double worst = 0;
  for (Eigen::Index v = 0; v < nodes.cols(); ++v) {
    const double z = nodes(2, v);
    if (z < 4 * kRadius || z > kLength - 4 * kRadius) continue;
    const double theory = -kForce * (kLength - z) * nodes(0, v) / second_moment;
    const double largest = kForce * (kLength - z) * kRadius / second_moment;
    const double found = analysis->cases[0].solution.stress(2, v);
    worst = std::max(worst, std::abs(found - theory) / largest);
  }
  EXPECT_LT(worst, 5e-3);
}

// A round tube that ships, clamped at one end, bends as a tube does and not as a bar.
TEST(RoundTubeTest, BendsAsBeamTheorySays) {
  constexpr double kLength = 0.4, kForce = 50;
  v1::TemplateBundle bundle = templates::ShippedAssembly("assemblies/bookshelf");
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      absl::Substitute("name: 'assemblies/pole' parts { name: 'pole' size { x: $0 } "
                       "item: 'items/aluminium-tube-25x2' }",
                       kLength),
      bundle.mutable_assembly()));
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      absl::Substitute(
          "name: 'templates/pole' assembly { assembly: 'assemblies/pole' } "
          "boundary_conditions { name: 'wall' kind: FIXED part: 'pole' face: 'x_min' } "
          "boundary_conditions { name: 'tip' kind: FORCE part: 'pole' face: 'x_max' "
          "components: '0' components: '0' components: '-$0' }",
          kForce),
      bundle.mutable_template_()));
  const auto model = ModelOf(bundle);
  ASSERT_TRUE(model.ok()) << model.status();
  DesignAnalysisOptions options;
  options.mesh.minimum_dihedral = 0;  // an eighth of the elements
  const auto analysis = AnalyzeDesign(*model, {"max_displacement", "mass"}, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double outer = 0.025, inner = 0.021;
  const double second_moment = std::numbers::pi / 64 * (std::pow(outer, 4) - std::pow(inner, 4));
  const Material& aluminium = model->analysis.materials[0];
  const double exact =
      kForce * std::pow(kLength, 3) / (3 * aluminium.youngs_modulus * second_moment);
  EXPECT_NEAR(analysis->metrics.at(0).value, exact, 0.01 * exact);
  const double section = std::numbers::pi / 4 * (outer * outer - inner * inner);
  const double mass = aluminium.density * section * kLength;
  EXPECT_NEAR(analysis->metrics.at(1).value, mass, 1e-6 * mass);
}

}  // namespace
}  // namespace mortise::simulator
