// Custom metrics on designs whose numbers can be told by hand: a bar of 0.4 x 0.04 x 0.04 m,
// E = 1e10 Pa, ν = 0, as a template of each kind; and those that ship.
#include "services/simulator/analysis/custom_metrics.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <map>

#include "absl/strings/str_cat.h"
#include "common/design/metric_registry.h"
#include "common/design/parameter_values.h"
#include "common/files/metric_codec.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/subject_metrics.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/mesh/box_assembly.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

EvaluatedTemplate Compiled(v1::TemplateBundle bundle) {
  const absl::Status complete = templates::FillAndCheck(bundle, templates::Trial::kDefaults);
  EXPECT_EQ(complete, absl::OkStatus());
  auto function = templates::Compile(bundle);
  EXPECT_TRUE(function.ok()) << function.status();
  EvaluatedTemplate compiled;
  compiled.design_template = *function;
  compiled.metrics = parametric::FromProto(parametric::MetricDefinitionsOf(bundle.template_()));
  return compiled;
}

absl::StatusOr<DesignAnalysis> Analyze(const EvaluatedTemplate& compiled,
                                       const std::string& definitions,
                                       std::vector<std::string> metrics = {},
                                       double element_size = 0.02, bool quadratic = true) {
  v1::MetricDefinitions asked;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(definitions, &asked)) << definitions;
  if (metrics.empty()) {
    for (const auto& metric : asked.expressions()) metrics.push_back(metric.name());
  }
  DesignAnalysisOptions options;
  options.mesh.element_size = element_size;
  options.mesh.quadratic = quadratic;
  options.parameters = parametric::Defaults(compiled.design_template->parameters());
  auto own = CustomMetricsOf(compiled, asked);
  if (!own.ok()) return own.status();
  options.custom_metrics = *std::move(own);
  const auto design = compiled.design_template->Evaluate(options.parameters);
  if (!design.ok()) return design.status();
  const auto model = MakeDesignModel(*compiled.design_template, options.parameters, *design);
  if (!model.ok()) return model.status();
  return AnalyzeDesign(*model, metrics, false, options);
}

std::string Metric(const std::string& unit, const std::string& expression,
                   const std::string& name = "m0") {
  return absl::StrCat("expressions { name: '", name, "' unit: '", unit, "' expression: \"",
                      expression, "\" } ");
}

double ValueOf(const absl::StatusOr<DesignAnalysis>& analysis, std::size_t i = 0) {
  EXPECT_TRUE(analysis.ok()) << analysis.status();
  return analysis.ok() ? analysis->metrics.at(i).value : 0;
}

std::string OnPart(const std::string& name, const std::string& kind, const std::string& face,
                   const std::vector<std::string>& components, const std::string& load_case = "") {
  std::string text = absl::StrCat("boundary_conditions { name: '", name, "' kind: ", kind,
                                  " part: 'bar' face: '", face, "' load_case: '", load_case, "' ");
  for (const std::string& component : components) {
    absl::StrAppend(&text, "components: '", component, "' ");
  }
  return text + "} ";
}

// Pulled by 100 N at its end; that of each kind of template.
std::map<std::string, v1::TemplateBundle> PulledBars() {
  const std::string of_parts =
      OnPart("wall", "FIXED", "x_min", {}) + OnPart("end", "FORCE", "x_max", {"100", "0", "0"});
  const auto of_solid = [](const std::string& list, const std::string& from,
                           const std::string& to) {
    return absl::StrCat(list, " { name: 'wall' fixed { faces: '", from, "' } } ", list,
                        " { name: 'end' force { faces: '", to, "' force { x: '100' } } } ");
  };
  return {{"parts", templates::PartsBar(of_parts)},
          {"assembly", templates::AssemblyBar(of_parts)},
          {"cad", templates::CadBar(of_solid("features", "bar.start", "bar.end"))},
          {"cage", templates::CageBar(of_solid("conditions", "x_min", "x_max"))}};
}

TEST(CustomMetrics, SpeakOfFacesAndPointsOfEveryKindOfTemplate) {
  const double stretch = 100 * 0.4 / (1e10 * 0.0016);
  const std::vector<std::tuple<std::string, std::string, double>> expected{
      {"m^2", "area('end')", 0.0016},
      {"m", "centroid_x('end')", 0.4},
      {"m", "centroid_y('end') - centroid_z('wall')", 0},
      {"m", "distance('wall', 'end')", 0.4},
      {"m", "distance('corner', 'end')", std::hypot(0.02, 0.02)},
      {"m", "mean_displacement('end')", stretch},
      {"m", "max_displacement_x('end')", stretch},
      {"m", "mean_displacement_x('middle')", stretch / 2},
      {"m", "max_displacement('wall')", 0},
      {"Pa", "mean_von_mises", 100 / 0.0016},
      {"1", "max_von_mises('end') / mean_von_mises('wall')", 1},
      {"Pa", "mean_von_mises('middle')", 100 / 0.0016},
      {"1", "max_von_mises('end') / von_mises_p99", 1},
      {"N m", "von_mises_integral", 100 * 0.4},
      {"N", "reaction_x('wall')", -100},
      {"N m", "moment_z('wall', 'origin')", 2},
      {"N m", "moment_y('wall', 'wall')", 0},
      {"N/m", "abs(reaction_x('wall', 'loads')) / mean_displacement_x('end')", 100 / stretch},
      {"1", "compliance / ('100 N' * mean_displacement_x('end'))", 1}};
  std::string definitions =
      "points { name: 'corner' x: 'length' } points { name: 'origin' } "
      "points { name: 'middle' x: 'length / 2' y: '0.02' z: '0.02' } ";
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto& [unit, expression, value] = expected[i];
    definitions += Metric(unit, expression, absl::StrCat("m", i));
  }
  for (const auto& [kind, bundle] : PulledBars()) {
    SCOPED_TRACE(kind);
    const auto analysis = Analyze(Compiled(bundle), definitions);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const auto& [unit, expression, value] = expected[i];
      EXPECT_NEAR(ValueOf(analysis, i), value, 1e-9 * std::max(1e-3, std::abs(value)))
          << expression;
    }
  }
}

TEST(CustomMetrics, KnowTheHeatThatFacesHaveAndGive) {
  const EvaluatedTemplate bar =
      Compiled(templates::PartsBar(OnPart("in", "HEAT_FLUX", "x_min", {"250"}) +
                                   OnPart("out", "CONVECTION", "x_max", {"20", "293.15"})));
  const double cold = 293.15 + 250.0 / 20, hot = cold + 250 * 0.4 / 0.5;
  const auto analysis =
      Analyze(bar, "points { name: 'middle' x: '0.2' y: '0.02' z: '0.02' } " +
                       Metric("K", "mean_temperature('in')", "a") +
                       Metric("K", "max_temperature('bar/y_min')", "b") +
                       Metric("K", "min_temperature('y_max')", "c") +
                       Metric("K", "mean_temperature('middle')", "d") +
                       Metric("W", "heat_dissipation('out')", "e") +
                       Metric("1", "heat_dissipation('out') / heat_dissipation", "f") +
                       Metric("W", "heat_dissipation('y_min')", "g"));
  const std::vector<double> expected{hot, hot, cold, (hot + cold) / 2, 250 * 0.0016, 1, 0};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(ValueOf(analysis, i), expected[i], 1e-8 * std::max(1.0, expected[i])) << i;
  }
  EXPECT_TRUE(analysis->cases.empty());
  const EvaluatedTemplate held =
      Compiled(templates::PartsBar(OnPart("hot", "TEMPERATURE", "x_min", {"400"}) +
                                   OnPart("cold", "TEMPERATURE", "x_max", {"300"})));
  const double flow = 0.5 * 100 / 0.4 * 0.0016;
  EXPECT_NEAR(ValueOf(Analyze(held, Metric("W", "heat_dissipation('cold')"))), flow, 1e-9);
  EXPECT_NEAR(ValueOf(Analyze(held, Metric("W", "heat_dissipation('hot')"))), -flow, 1e-9);
}

TEST(CustomMetrics, AreThoseOfTheLoadCaseNamedOrTheWorst) {
  const EvaluatedTemplate bar =
      Compiled(templates::PartsBar(OnPart("wall", "FIXED", "x_min", {}) +
                                   OnPart("pull", "FORCE", "x_max", {"100", "0", "0"}, "pulled") +
                                   OnPart("push", "FORCE", "x_max", {"-300", "0", "0"}, "pushed")));
  const double stretch = 100 * 0.4 / (1e10 * 0.0016);
  const auto analysis = Analyze(bar, Metric("m", "mean_displacement_x('pull')", "a") +
                                         Metric("m", "mean_displacement_x('pull', 'pulled')", "b") +
                                         Metric("N", "reaction_x('wall', 'pushed')", "c"));
  EXPECT_NEAR(ValueOf(analysis, 0), -3 * stretch, 1e-12);
  EXPECT_NEAR(ValueOf(analysis, 1), stretch, 1e-12);
  EXPECT_NEAR(ValueOf(analysis, 2), 300, 1e-6);
  const auto unknown = Analyze(bar, Metric("N", "reaction_x('wall', 'wind')"));
  EXPECT_THAT(std::string(unknown.status().message()),
              HasSubstr("'m0': metric_definitions: there is no load case 'wind'; there are pulled, "
                        "pushed"));
}

// Two bars, one behind the other, the second of four times the section.
TEST(CustomMetrics, SpeakOfTheStressOfParts) {
  DesignModel model;
  model.surface = mesh::AssembleBoxes(
      {{"thin", {0, 0, 0}, {0.1, 0.02, 0.02}}, {"thick", {0.1, -0.01, -0.01}, {0.2, 0.03, 0.03}}});
  model.analysis.materials.assign(2, {"test", 1000, 10e9, 0, 0});
  model.analysis.supports.push_back({{1, "x_max"}});
  model.analysis.forces.push_back({{0, "x_min"}, {-100, 0, 0}});
  const std::vector<std::pair<std::string, std::string>> texts{
      {"Pa", "mean_von_mises('thin')"},       {"Pa", "max_von_mises('thin')"},
      {"Pa", "rms_von_mises('thin')"},        {"Pa", "von_mises_p99('thin')"},
      {"N m", "von_mises_integral('thin')"},  {"N m", "von_mises_integral('thick', 'loads')"},
      {"Pa", "mean_von_mises('thick/x_max')"}};
  parametric::MetricDefinitions definitions;
  std::vector<std::string> names;
  for (const auto& [unit, text] : texts) {
    names.push_back(absl::StrCat("m", names.size()));
    definitions.expressions.push_back({names.back(), unit, text});
  }
  names.push_back("von_mises_integral");
  std::vector<FieldViolation> findings;
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.01;
  options.custom_metrics = parametric::MetricExpressions(
      definitions, {}, {}, UnitsOf(OfferedMetrics()), "metric_definitions", findings);
  ASSERT_TRUE(findings.empty()) << findings[0].message;
  const auto analysis = AnalyzeDesign(model, names, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const double thin = 100 / 0.0004;
  // Where the thin bar meets the thick one stress crowds into its corners.
  EXPECT_NEAR(ValueOf(analysis, 0), thin, 0.03 * thin);
  EXPECT_GT(ValueOf(analysis, 1), 1.05 * thin);
  EXPECT_GT(ValueOf(analysis, 2), ValueOf(analysis, 0));
  EXPECT_GT(ValueOf(analysis, 3), ValueOf(analysis, 2));
  EXPECT_LT(ValueOf(analysis, 3), ValueOf(analysis, 1));
  EXPECT_NEAR(ValueOf(analysis, 4), ValueOf(analysis, 0) * 0.1 * 0.0004, 1e-9);
  EXPECT_NEAR(ValueOf(analysis, 4) + ValueOf(analysis, 5), ValueOf(analysis, 7), 1e-9);
  EXPECT_NEAR(ValueOf(analysis, 6), thin / 4, 0.05 * thin / 4);
}

TEST(CustomMetrics, WithoutPhysicsNeedNoMeshAndNoSupports) {
  const EvaluatedTemplate bar = Compiled(templates::PartsBar(""));
  const auto analysis = Analyze(bar, Metric("kg/m^2", "mass / area('x_max')"));
  EXPECT_NEAR(ValueOf(analysis), 1000 * 0.4, 1e-9);
  EXPECT_FALSE(analysis->mesh.has_value());
}

TEST(CustomMetrics, OfPointsNeedNoSurface) {
  EvaluatedTemplate lamp = Compiled(templates::ShippedTemplate("templates/lamp"));
  auto own = CustomMetricsOf(lamp, {});
  ASSERT_TRUE(own.ok()) << own.status();
  EXPECT_FALSE(DemandsOf({"mass", "off_centre", "focus_distance"}, *own).surface);
  v1::MetricDefinitions asked;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      Metric("m", "distance('light_1', 'beam_1.half.socket')"), &asked));
  own = CustomMetricsOf(lamp, asked);
  ASSERT_TRUE(own.ok()) << own.status();
  EXPECT_TRUE(DemandsOf({"m0"}, *own).surface);
}

TEST(CustomMetrics, TellWhatIsWrongWithTheirName) {
  const EvaluatedTemplate bar = Compiled(PulledBars().at("parts"));
  const auto expect = [&bar](const std::string& definitions, absl::StatusCode code,
                             const std::string& message) {
    const auto analysis = Analyze(bar, definitions);
    EXPECT_EQ(analysis.status().code(), code) << definitions;
    EXPECT_THAT(std::string(analysis.status().message()), HasSubstr(message)) << definitions;
  };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  expect(Metric("m^2", "area('lid')"), kInvalid,
         "'m0': metric_definitions: there is no point, condition or face 'lid'; faces are x_max, "
         "x_min, y_max, y_min, z_max, z_min");
  expect("points { name: 'p' } " + Metric("m^2", "area('p')"), kInvalid,
         "'p' is a point; area is of faces");
  expect("points { name: 'p' x: '9' } " + Metric("m", "mean_displacement('p')"), kInvalid,
         "the point 'p' lies outside of the body");
  expect(Metric("Pa", "von_mises_p99('x_max')"), kInvalid,
         "'m0': metric_definitions: there is no part 'x_max'; parts are bar");
  expect(Metric("Pa", "mean_von_mises('lid')"), kInvalid,
         "there is no point, condition or face 'lid'; faces are x_max, x_min, y_max, y_min, z_max, "
         "z_min; parts are bar");
  expect(Metric("Pa", "mean_von_mises('bar', 'wind')"), kInvalid,
         "there is no load case 'wind'; there are loads");
  expect(Metric("m", "max_displacement('bar')"), kInvalid,
         "there is no point, condition or face 'bar'");
  expect(Metric("1", "1 / (length / '0.4 m' - 1)"), kInvalid,
         "metric_definitions.expressions[0].expression: 'm0': '1 / (length / '0.4 m' - 1)' divides "
         "by zero");
  expect(Metric("K", "max_temperature('end')"), absl::StatusCode::kFailedPrecondition,
         "there is no condition of heat");
  expect(Metric("m", "mass"), kInvalid, "'m0': has the unit kg, not m");
  expect(Metric("m", "weight"), kInvalid, "there is no parameter or metric 'weight'");
  v1::TemplateBundle bundle = PulledBars().at("cad");
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      Metric("m", "heigth"),
      bundle.mutable_template_()->mutable_cad()->mutable_metric_definitions()));
  EXPECT_THAT(std::string(templates::FillAndCheck(bundle, templates::Trial::kDefaults).message()),
              HasSubstr("cad.metric_definitions.expressions[0].expression: 'm0': column 1: there "
                        "is no parameter or metric 'heigth'"));
}

// What checks templates knows what is computed of designs.
TEST(CustomMetrics, MaySpeakOfAllThatIsOffered) {
  const auto known = UnitsOf(OfferedMetrics());
  const auto& offered = OfferedMetrics();
  ASSERT_EQ(known.size(), offered.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_EQ(known[i].name, offered[i].name);
    EXPECT_EQ(known[i].unit, offered[i].unit) << known[i].name;
  }
}

TEST(CustomMetrics, OfTheThesisShip) {
  const auto wrench = Analyze(
      Compiled(templates::ShippedTemplate("templates/wrench")),
      Metric("N", "reaction_y('held')") + Metric("m", "centroid_x('pull')", "lever"),
      {"pull_for_torque", "stress_for_torque", "max_von_mises", "m0", "lever"}, 0.006, false);
  EXPECT_NEAR(ValueOf(wrench, 0) * ValueOf(wrench, 4), 30, 1e-9);
  EXPECT_NEAR(ValueOf(wrench, 1) / ValueOf(wrench, 2), ValueOf(wrench, 0) / 250, 1e-9);
  EXPECT_NEAR(ValueOf(wrench, 3), 250, 0.01);
  const auto lamp = Analyze(Compiled(templates::ShippedTemplate("templates/lamp")),
                            Metric("m", "distance('light_3', 'beam_3.half.socket')", "aside"),
                            {"focus_distance", "off_centre", "center_of_mass_x", "aside"});
  EXPECT_GT(ValueOf(lamp, 0), 0.3);
  EXPECT_LT(ValueOf(lamp, 0), 1.5);
  EXPECT_GE(ValueOf(lamp, 1), std::abs(ValueOf(lamp, 2)));
  // The socket's centroid is that of its triangles, here of a polygon of a dozen unequal sides.
  EXPECT_NEAR(ValueOf(lamp, 3), 0, 1e-4 * 0.28);
  EXPECT_FALSE(lamp->mesh.has_value());
  const auto drum = Analyze(Compiled(templates::ShippedTemplate("templates/drum-brake")), "",
                            {"rim_heat_dissipation", "heat_dissipation"}, 0.02, false);
  EXPECT_GT(ValueOf(drum, 0), 0.3 * ValueOf(drum, 1));
  EXPECT_LT(ValueOf(drum, 0), ValueOf(drum, 1));
}

}  // namespace
}  // namespace mortise::simulator
