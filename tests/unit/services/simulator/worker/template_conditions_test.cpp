// Heat, load cases and all conditions of designs against exact solutions, from the template on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/design_conditions.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::simulator {
namespace {

using templates::BarMaterial;
using templates::PartsBar;
using ::testing::HasSubstr;

constexpr double kLength = 0.4;  // m
constexpr double kSide = 0.04;   // m

struct Subject {
  std::shared_ptr<const templates::Template> design_template;
  parametric::EvaluatedDesign design;
  DesignModel model;
};

Subject SubjectOf(v1::TemplateBundle bundle) {
  Subject subject;
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  subject.design_template = templates::Compile(bundle).value();
  const Eigen::VectorXd q = parametric::Defaults(subject.design_template->parameters());
  subject.design = subject.design_template->Evaluate(q).value();
  subject.model = MakeDesignModel(*subject.design_template, q, subject.design).value();
  return subject;
}

absl::StatusOr<DesignAnalysis> Analyze(const DesignModel& model,
                                       const std::vector<std::string>& metrics,
                                       double element_size = 0.03) {
  DesignAnalysisOptions options;
  options.mesh.element_size = element_size;
  return AnalyzeDesign(model, metrics, false, options);
}

double ValueOf(const DesignAnalysis& analysis, const std::string& name) {
  for (const Metric& metric : analysis.metrics) {
    if (metric.name == name) return metric.value;
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
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

// Held so that the bar may change its length and its section, without turning.
std::string Sliding() {
  return Condition("x", "SYMMETRIC", "x_min") + Condition("y", "SYMMETRIC", "y_min") +
         Condition("z", "SYMMETRIC", "z_min");
}

// Heat enters one end by a flux and leaves at the other: T falls evenly along the bar.
TEST(TemplateConditions, HeatFallsEvenlyAlongABarOfEveryKind) {
  const std::string of_parts = Condition("in", "HEAT_FLUX", "x_min", {"250"}) +
                               Condition("out", "CONVECTION", "x_max", {"20", "293.15"});
  const auto of_solid = [](const std::string& list, const std::string& from,
                           const std::string& to) {
    return absl::StrCat(list, " { name: 'in' heat { faces: '", from, "' flux: '250' } } ", list,
                        " { name: 'out' heat { faces: '", to,
                        "' convection: '20' ambient: '293.15' } } ");
  };
  const std::map<std::string, v1::TemplateBundle> kinds{
      {"parts", PartsBar(of_parts)},
      {"assembly", templates::AssemblyBar(of_parts)},
      {"cad", templates::CadBar(of_solid("features", "bar.start", "bar.end"))},
      {"cage", templates::CageBar(of_solid("conditions", "x_min", "x_max"))}};
  for (const auto& [kind, bundle] : kinds) {
    SCOPED_TRACE(kind);
    const Subject bar = SubjectOf(bundle);
    EXPECT_EQ(CheckHeated(bar.design), absl::OkStatus());
    const auto analysis = Analyze(
        bar.model, {"max_temperature", "min_temperature", "mean_temperature", "heat_dissipation"});
    ASSERT_TRUE(analysis.ok()) << analysis.status();
    EXPECT_TRUE(analysis->cases.empty());
    const double cold = 293.15 + 250.0 / 20, hot = cold + 250 * kLength / 0.5;
    EXPECT_NEAR(ValueOf(*analysis, "min_temperature"), cold, 1e-6);
    EXPECT_NEAR(ValueOf(*analysis, "max_temperature"), hot, 1e-6);
    EXPECT_NEAR(ValueOf(*analysis, "mean_temperature"), (cold + hot) / 2, 1e-6);
    EXPECT_NEAR(ValueOf(*analysis, "heat_dissipation"), 250 * kSide * kSide, 1e-9);
    EXPECT_LT(analysis->heat->imbalance, 1e-9);
    const mesh::TetrahedralMesh& mesh = *analysis->mesh;
    for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
      EXPECT_NEAR(analysis->heat->temperature[v], hot - (hot - cold) * mesh.nodes(0, v) / kLength,
                  1e-6);
    }
  }
}

// What leaves by a cold end counts, what enters by a hot one does not.
TEST(TemplateConditions, HeatIsDissipatedWhereItLeaves) {
  const Subject bar = SubjectOf(PartsBar(Condition("hot", "TEMPERATURE", "x_min", {"400"}) +
                                         Condition("cold", "TEMPERATURE", "x_max", {"300"})));
  const auto analysis = Analyze(bar.model, {"heat_dissipation"});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_NEAR(ValueOf(*analysis, "heat_dissipation"), 0.5 * 100 / kLength * kSide * kSide, 1e-9);
}

std::string Warm(const std::string& temperature) {
  return Condition("warm", "TEMPERATURE", "x_min", {temperature}) +
         Condition("warm2", "TEMPERATURE", "x_max", {temperature}) +
         "reference_temperature: '293.15' ";
}

// Held between two walls, free to widen: σ = −E α ΔT along the bar, nothing across.
TEST(TemplateConditions, AWarmBarBetweenWallsIsPressed) {
  const BarMaterial material{.poissons_ratio = 0.3};
  const Subject bar = SubjectOf(PartsBar(
      Sliding() + Condition("wall", "SYMMETRIC", "x_max") + Warm("293.15 + 80"), material));
  EXPECT_EQ(CheckLoaded(bar.design), absl::OkStatus());
  const auto analysis = Analyze(bar.model, {"max_von_mises", "max_displacement"});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double stress = 1e10 * 1e-5 * 80;
  EXPECT_NEAR(ValueOf(*analysis, "max_von_mises"), stress, 1e-6 * stress);
  const ElasticitySolution& solution = analysis->cases.at(0).solution;
  EXPECT_NEAR(solution.stress.row(0).maxCoeff(), -stress, 1e-6 * stress);
  // It widens by α ΔT (1 + ν) of its side.
  EXPECT_NEAR(ValueOf(*analysis, "max_displacement"), std::sqrt(2) * 1.3 * 1e-5 * 80 * kSide,
              1e-6 * kSide * 1e-3);
}

// Held on all sides: −E α ΔT / (1 − 2 ν) in every direction.
TEST(TemplateConditions, AWarmBarHeldOnAllSidesIsUnderPressure) {
  const BarMaterial material{.poissons_ratio = 0.3};
  std::string all;
  for (const char* face : {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"}) {
    all += Condition(face, "SYMMETRIC", face);
  }
  const Subject bar = SubjectOf(PartsBar(all + Warm("293.15 + 80"), material));
  const auto analysis = Analyze(bar.model, {"max_von_mises", "max_principal"});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double pressure = 1e10 * 1e-5 * 80 / (1 - 2 * 0.3);
  EXPECT_NEAR(ValueOf(*analysis, "max_principal"), -pressure, 1e-6 * pressure);
  EXPECT_NEAR(ValueOf(*analysis, "max_von_mises"), 0, 1e-6 * pressure);
}

// Its own weight presses a column by ρ g h at its foot.
TEST(TemplateConditions, AColumnCarriesItsWeight) {
  const Subject bar =
      SubjectOf(PartsBar(Sliding() + Condition("weight", "GRAVITY", "", {"-9.81", "0", "0"})));
  const auto analysis = Analyze(bar.model, {"max_von_mises", "max_displacement"});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double foot = 1000 * 9.81 * kLength;
  EXPECT_NEAR(ValueOf(*analysis, "max_von_mises"), foot, 1e-6 * foot);
  EXPECT_NEAR(ValueOf(*analysis, "max_displacement"), foot * kLength / 2 / 1e10, 1e-6 * 1e-7);
  EXPECT_NEAR(analysis->cases.at(0).solution.summary.total_load.x(), -9.81 * 1000 * 0.4 * 0.0016,
              1e-9);
}

// About its end: ρ ω² L² / 2 at the axis, ρ ω² L³ / 3 E at the tip.
TEST(TemplateConditions, ATurningBarIsPulled) {
  const Subject bar = SubjectOf(
      PartsBar(Sliding() + Condition("turn", "ROTATION", "", {"0", "0", "0", "0", "0", "300"})));
  const auto analysis = Analyze(bar.model, {"max_principal", "max_displacement"}, 0.02);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double stress = 1000 * 300 * 300 * kLength * kLength / 2;
  EXPECT_NEAR(ValueOf(*analysis, "max_principal"), stress, 2e-3 * stress);
  const double tip = 1000 * 300 * 300 * kLength * kLength * kLength / 3 / 1e10;
  EXPECT_NEAR(ValueOf(*analysis, "max_displacement"), tip, 2e-3 * tip);
}

// A wall that moves stretches the bar; the two other directions are free on it.
TEST(TemplateConditions, AMovedFaceStretchesTheBar) {
  const BarMaterial material{.poissons_ratio = 0.3};
  const Subject bar = SubjectOf(PartsBar(
      Sliding() + Condition("pull", "DISPLACEMENT", "x_max", {"length / 1000", "", ""}), material));
  EXPECT_EQ(CheckLoaded(bar.design), absl::OkStatus());
  const auto analysis = Analyze(bar.model, {"max_von_mises"});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_NEAR(ValueOf(*analysis, "max_von_mises"), 1e7, 10);
}

// Each load case is what the loads of its name and those without one do alone; metrics are the
// worst.
TEST(TemplateConditions, LoadCasesAreThoseSolvedAlone) {
  const std::string held = Condition("held", "FIXED", "x_min");
  const auto weight = [](const std::string& name) {
    return Condition("weight", "GRAVITY", "", {"0", "0", "-9.81"}, name);
  };
  const auto side = [](const std::string& name) {
    return Condition("side", "FORCE", "x_max", {"0", "3", "0"}, name);
  };
  const auto push = [](const std::string& name) {
    return Condition("push", "PRESSURE", "x_max", {"20000"}, name);
  };
  const std::vector<std::string> metrics{"max_displacement", "max_von_mises", "compliance",
                                         "strain_energy",    "max_principal", "stress_ratio",
                                         "relative_error"};
  const auto solved = [&](const std::string& conditions) {
    return Analyze(SubjectOf(PartsBar(held + conditions)).model, metrics).value();
  };
  const DesignAnalysis both = solved(weight("") + side("wind") + push("snow"));
  const DesignAnalysis wind = solved(weight("") + side(""));
  const DesignAnalysis snow = solved(weight("") + push(""));
  const DesignAnalysis only_weight = solved(weight(""));
  const DesignAnalysis all = solved(weight("") + side("") + push(""));
  ASSERT_EQ(both.cases.size(), 2u);
  ASSERT_EQ(wind.cases.size(), 1u);
  EXPECT_EQ(both.cases[0].name, "wind");
  EXPECT_EQ(both.cases[1].name, "snow");
  EXPECT_EQ(wind.cases[0].name, "loads");
  const double largest = wind.cases[0].solution.displacement.cwiseAbs().maxCoeff();
  const auto far = [](const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
    return (a - b).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(far(both.cases[0].solution.displacement, wind.cases[0].solution.displacement),
            1e-9 * largest);
  EXPECT_LT(far(both.cases[1].solution.displacement, snow.cases[0].solution.displacement),
            1e-9 * largest);
  // Together they are the sum, but for the weight, which is in both.
  EXPECT_LT(far(both.cases[0].solution.displacement + both.cases[1].solution.displacement -
                    only_weight.cases[0].solution.displacement,
                all.cases[0].solution.displacement),
            1e-9 * largest);
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    const double worst = std::max(wind.metrics[i].value, snow.metrics[i].value);
    EXPECT_NEAR(both.metrics[i].value, worst, 1e-6 * std::abs(worst)) << metrics[i];
  }
}

TEST(TemplateConditions, RefinementLooksAtEveryLoadCase) {
  const Subject bar = SubjectOf(PartsBar(
      Condition("held", "FIXED", "x_min") + Condition("a", "FORCE", "x_max", {"0", "3", "0"}, "a") +
      Condition("b", "PRESSURE", "x_max", {"1000"}, "b") + Warm("300")));
  DesignAnalysisOptions options;
  options.mesh.quadratic = false;
  options.wanted_error = 0.2;
  const auto analysis =
      AnalyzeDesign(bar.model, {"relative_error", "max_temperature"}, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  ASSERT_GE(analysis->refinements.size(), 2u);
  EXPECT_LE(ValueOf(*analysis, "relative_error"), 0.2);
  EXPECT_NEAR(ValueOf(*analysis, "max_temperature"), 300, 1e-9);
  EXPECT_EQ(analysis->heat->temperature.size(), analysis->mesh->nodes.cols());
}

TEST(TemplateConditions, SayWhatIsMissing) {
  const Subject cold = SubjectOf(
      PartsBar(Condition("held", "FIXED", "x_min") + Condition("f", "PRESSURE", "x_max", {"1"})));
  EXPECT_FALSE(HasHeat(cold.design));
  const absl::Status no_heat = CheckHeated(cold.design);
  EXPECT_EQ(DetailOf(no_heat).reason, "NO_HEAT");
  EXPECT_THAT(std::string(no_heat.message()), HasSubstr("CONVECTION"));
  EXPECT_EQ(DetailOf(Analyze(cold.model, {"max_temperature"}).status()).reason, "NO_HEAT");

  const Subject open = SubjectOf(PartsBar(Condition("in", "HEAT_FLUX", "x_min", {"250"})));
  EXPECT_EQ(DetailOf(CheckHeated(open.design)).reason, "FREE_TEMPERATURE");
  EXPECT_EQ(DetailOf(Analyze(open.model, {"max_temperature"}).status()).reason, "FREE_TEMPERATURE");
  EXPECT_EQ(DetailOf(CheckLoaded(open.design)).reason, "NO_LOADS");
  EXPECT_EQ(DetailOf(CheckSupported(open.design)).reason, "NO_SUPPORTS");

  const BarMaterial insulator{.thermal_conductivity = 0};
  v1::TemplateBundle bundle =
      PartsBar(Condition("hot", "TEMPERATURE", "x_min", {"300"}), insulator);
  ASSERT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  const auto function = templates::Compile(bundle).value();
  const Eigen::VectorXd q = parametric::Defaults(function->parameters());
  const absl::Status status = MakeDesignModel(*function, q, function->Evaluate(q).value()).status();
  EXPECT_EQ(DetailOf(status).reason, "NO_CONDUCTIVITY");
  EXPECT_EQ(DetailOf(status).field, "materials/spruce");
}

// Wood conducts alike in all directions, as the catalog has it, whatever its grain.
TEST(TemplateConditions, HeatGoesThroughWoodWithAGrain) {
  v1::TemplateBundle bundle = templates::ShippedTemplate("templates/table");
  v1::BoundaryCondition& sun = *bundle.mutable_template_()->add_boundary_conditions();
  sun.set_name("sun");
  sun.set_kind(v1::BoundaryCondition::HEAT_FLUX);
  sun.set_part("top");
  sun.set_face("cap");
  sun.add_components("100");
  v1::BoundaryCondition& air = *bundle.mutable_template_()->add_boundary_conditions();
  air.set_name("air");
  air.set_kind(v1::BoundaryCondition::CONVECTION);
  air.set_part("top");
  air.set_face("cap");
  air.add_components("10");
  air.add_components("293.15");
  const Subject table = SubjectOf(bundle);
  const auto analysis = Analyze(table.model, {"max_temperature", "heat_dissipation"}, 0.2);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  // In and out through the same face: all of the table is as warm as the air and 10 K.
  EXPECT_NEAR(ValueOf(*analysis, "max_temperature"), 303.15, 1e-6);
  EXPECT_EQ(table.model.analysis.materials[0].orthotropy->conductivity.minCoeff(),
            table.model.analysis.materials[0].conductivity);
}

}  // namespace
}  // namespace mortise::simulator
