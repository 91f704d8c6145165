// Supports, loads and heat that a request gives to a design whose template has none.
#include "services/simulator/worker/analysis_setup.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/design_conditions.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::simulator {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;

v1::AnalysisSetup SetupOf(const std::string& text) {
  v1::AnalysisSetup setup;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &setup)) << text;
  return setup;
}

// A bar at its defaults, with these conditions of its template.
struct Bar {
  std::shared_ptr<const templates::Template> design_template;
  Eigen::VectorXd parameters;
  parametric::EvaluatedDesign design;

  explicit Bar(const std::string& conditions) {
    v1::TemplateBundle bundle = templates::PartsBar(conditions);
    EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
    design_template = templates::Compile(bundle).value();
    parameters = parametric::Defaults(design_template->parameters());
    design = design_template->Evaluate(parameters).value();
  }

  double MaxDisplacement() const {
    const DesignModel model = MakeDesignModel(*design_template, parameters, design).value();
    DesignAnalysisOptions options;
    options.mesh.element_size = 0.03;
    return AnalyzeDesign(model, {"max_displacement"}, false, options).value().metrics[0].value;
  }
};

std::vector<FieldViolation> FaultsOf(const std::string& setup, const std::string& conditions = "") {
  Bar bar(conditions);
  v1::AnalysisSetup message = SetupOf(setup);
  return AllViolationsOf(AddSetup(message, bar.design));
}

auto IsFault(const std::string& field, const std::string& message) {
  return AllOf(Field(&FieldViolation::field, field),
               Field(&FieldViolation::message, HasSubstr(message)));
}

constexpr char kHeldAndPulled[] =
    "boundary_conditions { name: 'foot' kind: FIXED part: 'bar' face: 'x_min' } "
    "boundary_conditions { name: 'pull' kind: FORCE part: 'bar' face: 'x_max' "
    "components: '0' components: '0' components: '-100' } ";

TEST(AnalysisSetup, ActsAsConditionsOfTheTemplateDo) {
  const Bar of_template(kHeldAndPulled);
  Bar of_request("");
  EXPECT_FALSE(CheckSupported(of_request.design).ok());
  v1::AnalysisSetup setup = SetupOf(
      "boundary_conditions { kind: FIXED face: 'x_min' } "
      "boundary_conditions { kind: FORCE face: 'bar/x_max' force { z: -100 } }");
  ASSERT_EQ(AddSetup(setup, of_request.design), absl::OkStatus());
  EXPECT_EQ(CheckSupported(of_request.design), absl::OkStatus());
  EXPECT_NEAR(of_request.MaxDisplacement(), of_template.MaxDisplacement(), 1e-12);
  // What was left out is told.
  EXPECT_EQ(setup.boundary_conditions(0).name(), "setup_1");
  EXPECT_EQ(setup.boundary_conditions(0).part(), "bar");
  EXPECT_EQ(setup.boundary_conditions(1).part(), "bar");
  EXPECT_EQ(setup.boundary_conditions(1).face(), "x_max");
}

TEST(AnalysisSetup, ComesBesideConditionsOfTheTemplate) {
  Bar bar(kHeldAndPulled);
  const double alone = bar.MaxDisplacement();
  v1::AnalysisSetup setup =
      SetupOf("boundary_conditions { kind: FORCE face: 'x_max' force { z: -100 } }");
  ASSERT_EQ(AddSetup(setup, bar.design), absl::OkStatus());
  EXPECT_NEAR(bar.MaxDisplacement(), 2 * alone, 1e-6 * alone);
}

// As a worker reads the setup that a service has completed.
TEST(AnalysisSetup, IsTheSameWhenItIsAddedAgain) {
  Bar bar(""), again("");
  v1::AnalysisSetup setup = SetupOf("boundary_conditions { kind: FIXED face: 'bar/x_min' }");
  ASSERT_EQ(AddSetup(setup, bar.design), absl::OkStatus());
  v1::AnalysisSetup completed = setup;
  ASSERT_EQ(AddSetup(completed, again.design), absl::OkStatus());
  EXPECT_EQ(completed.SerializeAsString(), setup.SerializeAsString());
}

TEST(AnalysisSetup, TellsWhichPartsAndFacesThereAre) {
  EXPECT_THAT(FaultsOf("boundary_conditions { kind: FIXED face: 'x_minn' } "
                       "boundary_conditions { kind: FIXED part: 'bra' face: 'x_min' } "
                       "boundary_conditions { kind: FIXED } "
                       "boundary_conditions { kind: GRAVITY face: 'x_min' }"),
              ElementsAre(IsFault("setup.boundary_conditions[0].face", "did you mean 'x_min'?"),
                          IsFault("setup.boundary_conditions[1].part", "did you mean 'bar'?"),
                          IsFault("setup.boundary_conditions[2].face", "is missing"),
                          IsFault("setup.boundary_conditions[3].face", "the whole body")));
}

TEST(AnalysisSetup, RefusesNamesAndNumbersThatMeanNothing) {
  EXPECT_THAT(FaultsOf("boundary_conditions { face: 'x_min' } "
                       "boundary_conditions { name: 'pull' kind: FIXED face: 'x_min' } "
                       "boundary_conditions { name: 'a b' kind: FIXED face: 'x_min' } "
                       "boundary_conditions { kind: CONVECTION face: 'x_min' temperature: 300 } "
                       "boundary_conditions { kind: FIXED face: 'x_min' load_case: 'wind' } "
                       "boundary_conditions { kind: DISPLACEMENT face: 'x_min' } "
                       "reference_temperature: -1",
                       kHeldAndPulled),
              ElementsAre(IsFault("setup.boundary_conditions[0].kind", "kind"),
                          IsFault("setup.boundary_conditions[1].name", "there already"),
                          IsFault("setup.boundary_conditions[2].name", "identifier"),
                          IsFault("setup.boundary_conditions[3].coefficient", "greater than 0"),
                          IsFault("setup.boundary_conditions[4].load_case", "only of loads"),
                          IsFault("setup.boundary_conditions[5]", "is free along"),
                          IsFault("setup.reference_temperature", "greater than 0")));
}

TEST(AnalysisSetup, RefusesNumbersOfAnotherKind) {
  EXPECT_THAT(FaultsOf("boundary_conditions { kind: PRESSURE face: 'x_max' force { z: -800 } } "
                       "boundary_conditions { kind: FIXED face: 'x_min' displacement { x: 0 } } "
                       "boundary_conditions { kind: FORCE face: 'x_max' force { z: -1 } "
                       "temperature: 300 }"),
              ElementsAre(IsFault("setup.boundary_conditions[0].force", "PRESSURE"),
                          IsFault("setup.boundary_conditions[1].displacement", "FIXED"),
                          IsFault("setup.boundary_conditions[2].temperature", "FORCE")));
}

// The template's temperature may be for a condition that this design does not have.
TEST(AnalysisSetup, IsNotBlamedForTheTemplatesTemperature) {
  Bar bar(kHeldAndPulled);
  bar.design.reference_temperature = 293;
  v1::AnalysisSetup setup =
      SetupOf("boundary_conditions { kind: FORCE face: 'x_max' force { z: -100 } }");
  EXPECT_EQ(AddSetup(setup, bar.design), absl::OkStatus());
}

TEST(AnalysisSetup, HasNoMoreThan200Conditions) {
  std::string many;
  for (int i = 0; i <= 200; ++i) many += "boundary_conditions { kind: FIXED face: 'x_min' } ";
  EXPECT_THAT(FaultsOf(many), ElementsAre(IsFault("setup.boundary_conditions", "more than 200")));
}

}  // namespace
}  // namespace mortise::simulator
