// Shape and fields of designs of every kind, from the template on: against exact solutions and
// against the metrics.
#include "services/simulator/analysis/design_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/fields/fields_file.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::simulator {
namespace {

using fields::DesignFields;
using templates::PartsBar;
using ::testing::HasSubstr;

constexpr double kLength = 0.4;  // m
constexpr double kSide = 0.04;   // m

DesignModel ModelOf(v1::TemplateBundle bundle) {
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  const auto function = templates::Compile(bundle).value();
  const Eigen::VectorXd q = parametric::Defaults(function->parameters());
  return MakeDesignModel(*function, q, function->Evaluate(q).value()).value();
}

struct Analyzed {
  DesignAnalysis analysis;
  absl::StatusOr<DesignFields> design;
};

// The design, through its file and back.
Analyzed Analyze(const DesignModel& model, const std::vector<std::string>& metrics,
                 const FieldsDemand& demand) {
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.03;
  DemandFields(demand, options);
  Analyzed analyzed{AnalyzeDesign(model, metrics, false, options).value(),
                    absl::UnknownError("not collected")};
  analyzed.design = CollectFields(model, analyzed.analysis, demand);
  if (!analyzed.design.ok()) return analyzed;
  const auto bytes = fields::WriteFields(*analyzed.design);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  if (bytes.ok()) analyzed.design = fields::ReadFields(*bytes);
  return analyzed;
}

const fields::Field& FieldOf(const DesignFields& design, const std::string& name,
                             const std::string& load_case = "") {
  for (const fields::Field& field : design.fields) {
    if (field.name == name && field.load_case == load_case) return field;
  }
  ADD_FAILURE() << "there is no " << name << " in '" << load_case << "'";
  return design.fields.front();
}

double Volume(const DesignFields& design) {
  double volume = 0;
  for (Eigen::Index e = 0; e < design.tetrahedra.cols(); ++e) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.col(k) =
          design.nodes.col(design.tetrahedra(k + 1, e)) - design.nodes.col(design.tetrahedra(0, e));
    }
    volume += edges.determinant() / 6;
  }
  return volume;
}

// The area of a region, with the outward normal that its triangles have.
Eigen::Vector3d AreaOf(const DesignFields& design, const std::string& name) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  const auto region = std::ranges::find(design.regions, name, &fields::Region::name);
  if (region == design.regions.end()) {
    ADD_FAILURE() << "there is no region " << name;
    return area;
  }
  for (const int t : region->triangles) {
    const Eigen::Vector3d a = design.nodes.col(design.triangles(0, t));
    area += (design.nodes.col(design.triangles(1, t)) - a)
                .cross(design.nodes.col(design.triangles(2, t)) - a) /
            2;
  }
  return area;
}

std::string Condition(const std::string& name, const std::string& kind, const std::string& face,
                      const std::vector<std::string>& components = {},
                      const std::string& load_case = "") {
  std::string text = absl::StrCat("boundary_conditions { name: '", name, "' kind: ", kind, " ");
  if (!face.empty()) absl::StrAppend(&text, "part: 'bar' face: '", face, "' ");
  for (const std::string& component : components) {
    absl::StrAppend(&text, "components: '", component, "' ");
  }
  return absl::StrCat(text, "load_case: '", load_case, "' } ");
}

// A bar that heat goes through from one end to the other, as each kind of template.
std::map<std::string, v1::TemplateBundle> WarmBars() {
  const std::string of_parts = Condition("in", "HEAT_FLUX", "x_min", {"250"}) +
                               Condition("out", "CONVECTION", "x_max", {"20", "293.15"});
  const auto of_solid = [](const std::string& list, const std::string& from,
                           const std::string& to) {
    return absl::StrCat(list, " { name: 'in' heat { faces: '", from, "' flux: '250' } } ", list,
                        " { name: 'out' heat { faces: '", to,
                        "' convection: '20' ambient: '293.15' } } ");
  };
  return {{"parts", PartsBar(of_parts)},
          {"assembly", templates::AssemblyBar(of_parts)},
          {"cad", templates::CadBar(of_solid("features", "bar.start", "bar.end"))},
          {"cage", templates::CageBar(of_solid("conditions", "x_min", "x_max"))}};
}

TEST(DesignFieldsTest, DesignsOfEveryKindGiveShapeRegionsAndFields) {
  for (const auto& [kind, bundle] : WarmBars()) {
    SCOPED_TRACE(kind);
    const DesignModel model = ModelOf(bundle);
    const Analyzed bar = Analyze(model, {"volume", "max_temperature"},
                                 {.tetrahedra = true, .fields = {"temperature", "heat_flux"}});
    ASSERT_TRUE(bar.design.ok()) << bar.design.status();
    const DesignFields& design = *bar.design;
    EXPECT_EQ(design.nodes, bar.analysis.mesh->nodes);
    EXPECT_NEAR(Volume(design), bar.analysis.metrics[0].value, 1e-12);
    const fields::Field& temperature = FieldOf(design, "temperature");
    EXPECT_EQ(temperature.unit, "K");
    EXPECT_EQ(temperature.values.maxCoeff(), bar.analysis.metrics[1].value);
    const double hot = 293.15 + 250.0 / 20 + 250 * kLength / 0.5;
    for (Eigen::Index v = 0; v < design.nodes.cols(); ++v) {
      EXPECT_NEAR(temperature.values(0, v), hot - 500 * design.nodes(0, v), 1e-6);
    }
    const fields::Field& flux = FieldOf(design, "heat_flux");
    EXPECT_EQ(flux.place, fields::FieldPlace::kElements);
    EXPECT_LT((flux.values.colwise() - Eigen::Vector3d(250, 0, 0)).cwiseAbs().maxCoeff(), 1e-6);
    const double section = kSide * kSide;
    EXPECT_LT((AreaOf(design, "in") - Eigen::Vector3d(-section, 0, 0)).norm(), 1e-12);
    EXPECT_LT((AreaOf(design, "out") - Eigen::Vector3d(section, 0, 0)).norm(), 1e-12);
  }
}

TEST(DesignFieldsTest, EveryLoadCaseHasItsFields) {
  const DesignModel model =
      ModelOf(PartsBar(Condition("held", "FIXED", "x_min") +
                       Condition("side", "FORCE", "x_max", {"0", "3", "0"}, "wind") +
                       Condition("push", "PRESSURE", "x_max", {"20000"}, "snow")));
  const Analyzed bar =
      Analyze(model, {"max_von_mises", "max_principal", "max_displacement"},
              {.tetrahedra = true,
               .fields = {"von_mises", "max_principal", "displacement", "stress", "reaction"}});
  ASSERT_TRUE(bar.design.ok()) << bar.design.status();
  ASSERT_EQ(bar.design->fields.size(), 10u);
  EXPECT_EQ(bar.design->fields[1].name, "von_mises");
  EXPECT_EQ(bar.design->fields[1].load_case, "snow");
  const auto worst = [&](const std::string& name) {
    return std::max(FieldOf(*bar.design, name, "wind").values.colwise().norm().maxCoeff(),
                    FieldOf(*bar.design, name, "snow").values.colwise().norm().maxCoeff());
  };
  EXPECT_EQ(worst("von_mises"), bar.analysis.metrics[0].value);
  EXPECT_DOUBLE_EQ(worst("displacement"), bar.analysis.metrics[2].value);
  const Eigen::Vector3d reaction = FieldOf(*bar.design, "reaction", "wind").values.rowwise().sum();
  EXPECT_LT((reaction - Eigen::Vector3d(0, -3, 0)).norm(), 1e-6);
  EXPECT_EQ(FieldOf(*bar.design, "stress", "snow").values.rows(), 6);
}

TEST(DesignFieldsTest, TheSurfaceHasTheNodesOfItsTrianglesOnly) {
  const DesignModel model = ModelOf(PartsBar(Condition("held", "FIXED", "x_min") +
                                             Condition("f", "PRESSURE", "x_max", {"20000"})));
  const FieldsDemand all{.tetrahedra = true, .fields = {"displacement"}};
  FieldsDemand outside = all;
  outside.tetrahedra = false;
  outside.regions = {"held"};
  const DesignFields volume = Analyze(model, {"mass"}, all).design.value();
  const DesignFields surface = Analyze(model, {"mass"}, outside).design.value();
  EXPECT_EQ(surface.tetrahedra.cols(), 0);
  EXPECT_EQ(surface.triangles.cols(), volume.triangles.cols());
  EXPECT_LT(surface.nodes.cols(), volume.nodes.cols());
  ASSERT_EQ(surface.regions.size(), 1u);
  const auto of_triangles = [](const DesignFields& design, const Eigen::MatrixXd& of_nodes) {
    return Eigen::MatrixXd(of_nodes(Eigen::all, design.triangles.reshaped().eval()));
  };
  EXPECT_EQ(of_triangles(surface, surface.nodes), of_triangles(volume, volume.nodes));
  EXPECT_EQ(of_triangles(surface, FieldOf(surface, "displacement", "loads").values),
            of_triangles(volume, FieldOf(volume, "displacement", "loads").values));
}

// Nothing that is asked for needs a mesh: the parts as they were joined are enough.
TEST(DesignFieldsTest, TheSurfaceAloneNeedsNoMesh) {
  const DesignModel model = ModelOf(PartsBar(Condition("held", "FIXED", "x_min")));
  const Analyzed bar = Analyze(model, {"mass"}, {});
  ASSERT_TRUE(bar.design.ok()) << bar.design.status();
  EXPECT_FALSE(bar.analysis.mesh.has_value());
  EXPECT_EQ(bar.design->triangles.rows(), 3);
  EXPECT_LT((AreaOf(*bar.design, "x_max") - Eigen::Vector3d(kSide * kSide, 0, 0)).norm(), 1e-12);
  EXPECT_LT((AreaOf(*bar.design, "held") + AreaOf(*bar.design, "x_max")).norm(), 1e-12);
}

TEST(DesignFieldsTest, ModesAreThoseThatDeform) {
  const DesignModel model = ModelOf(PartsBar(Condition("held", "FIXED", "x_min")));
  const Analyzed bar =
      Analyze(model, {"mass"}, {.tetrahedra = true, .fields = {"mode_shape"}, .modes = 3});
  ASSERT_TRUE(bar.design.ok()) << bar.design.status();
  ASSERT_EQ(bar.design->fields.size(), 3u);
  EXPECT_EQ(FieldOf(*bar.design, "mode_shape", "mode 3").values,
            bar.analysis.vibration->modes[2].shape);
}

// What the air presses with on the nodes comes to the force of the flow, but for its friction.
TEST(DesignFieldsTest, ThePressureOfTheAirIsOnTheOutside) {
  const DesignModel model = ModelOf(PartsBar(Condition("held", "FIXED", "x_min")));
  const FieldsDemand demand{.tetrahedra = true, .fields = {"air_pressure"}};
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.01;
  options.airflow.wind = {0, 10, 0};
  options.airflow.cells = 8000;
  DemandFields(demand, options);
  const auto analysis = AnalyzeDesign(model, {"mass"}, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const auto design = CollectFields(model, *analysis, demand);
  ASSERT_TRUE(design.ok()) << design.status();
  const Eigen::MatrixXd& pressure = FieldOf(*design, "air_pressure").values;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::VectorXi is_outside = Eigen::VectorXi::Zero(design->nodes.cols());
  for (const auto& triangle : design->triangles.colwise()) {
    const Eigen::Vector3d a = design->nodes.col(triangle[0]);
    const Eigen::Vector3d area =
        (design->nodes.col(triangle[1]) - a).cross(design->nodes.col(triangle[2]) - a) / 2;
    force -=
        area * (pressure(0, triangle[0]) + pressure(0, triangle[1]) + pressure(0, triangle[2])) / 3;
    for (const int node : triangle) is_outside[node] = 1;
  }
  const Eigen::Vector3d pushed = analysis->airflow->force - analysis->airflow->friction;
  EXPECT_GT(pushed.y(), 0);
  EXPECT_LT((force - pushed).norm(), 0.1 * pushed.norm()) << force << " for " << pushed;
  const double stagnation = 0.5 * options.airflow.air.Density() * 100;
  EXPECT_NEAR(pressure.maxCoeff(), stagnation, 0.3 * stagnation);
  for (Eigen::Index v = 0; v < pressure.cols(); ++v) {
    if (is_outside[v] == 0) {
      EXPECT_EQ(pressure(0, v), 0);
    }
  }
}

class ShippedShapesTest : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedShapesTest, HaveARegionForEveryCondition) {
  const DesignModel model = ModelOf(templates::ShippedTemplate(GetParam()));
  const auto shape = CollectFields(model, DesignAnalysis(), {});
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_EQ(fields::Check(*shape), absl::OkStatus());
  for (const auto& [condition, face] : model.condition_faces) {
    const auto region = std::ranges::find(shape->regions, condition, &fields::Region::name);
    ASSERT_NE(region, shape->regions.end()) << condition;
    EXPECT_FALSE(region->triangles.empty()) << condition;
  }
}

std::vector<std::string> TemplatesThatShip() {
  std::vector<std::string> names;
  for (const v1::Template& shipped : templates::ShippedCollection().templates) {
    // Those of assemblies come with theirs: shipped_surfaces_test looks at all of these.
    if (!shipped.has_assembly()) names.push_back(shipped.name());
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedShapesTest, ::testing::ValuesIn(TemplatesThatShip()),
                         [](const auto& shipped) {
                           std::string name = shipped.param.substr(shipped.param.find('/') + 1);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(DesignFieldsTest, WhatIsNotThereIsNamedWithWhatIs) {
  const DesignModel model = ModelOf(PartsBar(Condition("held", "FIXED", "x_min")));
  const absl::Status region =
      Analyze(model, {"mass"}, {.regions = {"x_max", "lid"}}).design.status();
  EXPECT_EQ(DetailOf(region).field, "design_fields.regions[1]");
  EXPECT_THAT(std::string(region.message()), HasSubstr("'lid'; there are held, "));
  const DesignModel warm = ModelOf(WarmBars().at("parts"));
  const absl::Status elements =
      Analyze(warm, {"mass"}, {.fields = {"temperature", "heat_flux"}}).design.status();
  EXPECT_EQ(DetailOf(elements).field, "design_fields.fields[1]") << elements;
}

}  // namespace
}  // namespace mortise::simulator
