// Bad templates: everything wrong is told at once, with its place; nothing crashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::cad {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

std::vector<FieldViolation> FindingsOf(const std::string& parameters, const std::string& features) {
  const auto definition = ParseCadTemplateText(TemplateText(parameters, features), "test");
  EXPECT_TRUE(definition.ok()) << definition.status();
  return ValidateCadTemplate(*definition);
}

std::vector<std::string> PlacesOf(const std::vector<FieldViolation>& findings) {
  std::vector<std::string> places;
  for (const auto& finding : findings) places.push_back(finding.field);
  return places;
}

testing::Matcher<const std::vector<FieldViolation>&> Tells(const std::string& field,
                                                           const std::string& message) {
  return Contains(AllOf(Field(&FieldViolation::field, field),
                        Field(&FieldViolation::message, HasSubstr(message))));
}

TEST(BadTemplate, TellsEverythingAtOnce) {
  const auto findings = FindingsOf(
      "parameters { name: 'width' unit: 'm' minimum: 2 maximum: 1 default_value: 1 } "
      "parameters { name: 'width' minimum: 0 maximum: 1 default_value: 3 } "
      "parameters { name: 'pi' unit: 'm' minimum: nan maximum: 1 default_value: 0 } "
      "definitions { name: 'half' value: 'later / 2' } definitions { name: 'later' value: '1' } ",
      "features { name: 'a' sketch { profiles { name: 'start' circle { radius: 'nobody' } } "
      "profiles { name: 'p' hole_of: 'q' circle { radius: '1' } } } } "
      "features { name: 'a' extrude { sketch: 'b' } } "
      "features { name: '9' fillet { edges: 'x.y' radius: '1 +' } } "
      "features { name: 'b' sketch { } } "
      "features { name: 'r' revolve { sketch: 'a' } } "
      "features { name: 'm' circular_pattern { feature: 'b' count: '2' } } "
      "features { name: 'h' heat { } }");
  EXPECT_THAT(
      PlacesOf(findings),
      UnorderedElementsAre(
          "parameters[0].maximum", "parameters[1].name", "parameters[1].unit",
          "parameters[1].default_value", "parameters[2].name", "parameters[2]",
          "definitions[0].value", "features[0].sketch.profiles[0].name",
          "features[0].sketch.profiles[0].circle.radius", "features[0].sketch.profiles[1].hole_of",
          "features[1].name", "features[1].extrude.sketch", "features[1].extrude.to",
          "features[2].name", "features[2].fillet.edges[0]", "features[2].fillet.radius",
          "features[3].sketch.profiles", "features[4].revolve.axis_direction",
          "features[5].circular_pattern.feature", "features[6].heat.faces",
          "features[6].heat.flux"));
  EXPECT_THAT(findings, Tells("features[1].extrude.sketch", "'b' is not before this feature"));
}

// The kernel would take minutes over them.
TEST(BadTemplate, MakesNoMoreCopiesThanTheKernelCombinesInSeconds) {
  const auto grid = [](const char* count, const char* rows) {
    return absl::StrCat("linear_pattern { feature: 'h' step { x: '0.001' } count: '", count,
                        "' second_step { y: '0.001' } second_count: '", rows, "' } } ");
  };
  const std::string hole =
      BlockText() +
      "features { name: 'h' hole { face: 'block.end' position { x: '-0.02' y: '-0.02' } "
      "diameter: '0.0005' } } ";
  const auto refusal = [&](const std::string& patterns) {
    const auto definition = ParseCadTemplateText(TemplateText("", hole + patterns), "test");
    EXPECT_TRUE(definition.ok()) << definition.status();
    const auto model = FeatureModel::Create(*definition);
    return model.ok() ? model->Regenerate(model->Defaults()).status() : model.status();
  };
  EXPECT_EQ(DetailOf(refusal("features { name: 'z' " + grid("32", "31"))).field,
            "features[3].linear_pattern.count");
  EXPECT_EQ(DetailOf(refusal("features { name: 'z' " + grid("201", "1"))).field,
            "features[3].linear_pattern.count");
  EXPECT_EQ(DetailOf(refusal("features { name: 'y' " + grid("20", "10") + "features { name: 'z' " +
                             grid("2", "2")))
                .field,
            "features[4]");
}

TEST(BadTemplate, LimitsTextsAndKnowsUnits) {
  const auto findings =
      FindingsOf(absl::StrCat("description: '", std::string(10'001, 'x'),
                              "' parameters { name: 'a' title: '", std::string(201, 'x'),
                              "' unit: 'inch' minimum: 0 maximum: 1 default_value: 0 } "),
                 BlockText());
  EXPECT_THAT(PlacesOf(findings),
              UnorderedElementsAre("description", "parameters[0].title", "parameters[0].unit"));
}

TEST(BadTemplate, TellsWhatReferencesCannotMean) {
  const auto findings = FindingsOf(
      "", BlockText() +
              "features { name: 'f' fillet { radius: '0.001' "
              "edges: 'block.outline.sideways & block.end' edges: 'block[1].end & *' "
              "edges: 'nothing & *' edges: 'block_sketch & *' edges: 'f & *' edges: 'block.end' "
              "edges: 'block.bore & block.end' } } "
              "features { name: 'b' boolean { tools: 'block' tools: 'c' } } "
              "features { name: 'c' extrude { sketch: 'block_sketch' to: '1' operation: CUT body: "
              "'d' } }");
  EXPECT_THAT(findings,
              Tells("features[2].fillet.edges[0]", "'block' makes no face 'outline.sideways'"));
  EXPECT_THAT(findings, Tells("features[2].fillet.edges[1]", "'block' is not a pattern"));
  EXPECT_THAT(findings, Tells("features[2].fillet.edges[2]", "there is no feature 'nothing'"));
  EXPECT_THAT(findings, Tells("features[2].fillet.edges[3]", "makes no face"));
  EXPECT_THAT(findings, Tells("features[2].fillet.edges[4]", "'f' is not before this feature"));
  EXPECT_THAT(findings, Tells("features[2].fillet.edges[5]", "must be like 'face & face'"));
  EXPECT_THAT(findings, Tells("features[2].fillet.edges[6]", "makes no face 'bore'"));
  EXPECT_THAT(findings, Tells("features[3].boolean.operation", "must be UNITE"));
  EXPECT_THAT(findings, Tells("features[3].boolean.tools[1]", "there is no body 'c'"));
  EXPECT_THAT(findings, Tells("features[4].extrude.body", "there is no body 'd'"));
}

TEST(BadTemplate, TellsNumbersThatGoWrongSomewhereInTheRange) {
  const auto findings = FindingsOf(
      Range("a", -1, 1, 0.5) + Range("b", 0, 1, 0.5),
      "features { name: 's' sketch { profiles { name: 'c' circle { center { x: '1 / b' y: "
      "'sqrt(a)' } radius: 'a' } } } } "
      "features { name: 'e' extrude { sketch: 's' to: '0.1 - b / 2' } } "
      "features { name: 'p' linear_pattern { feature: 'e' step { x: '1' } count: '2 + b' } } "
      "features { name: 'w' heat { faces: 'e.end' temperature: 'a * 300' } } "
      "features { name: 'd' draft { faces: 'e.c' neutral: 'e.start' angle: '2' } }");
  EXPECT_THAT(findings, Tells("features[0].sketch.profiles[0].circle.center.x", "divides by zero"));
  EXPECT_THAT(findings, Tells("features[0].sketch.profiles[0].circle.center.y", "no finite value"));
  EXPECT_THAT(findings,
              Tells("features[0].sketch.profiles[0].circle.radius", "must be greater than 0"));
  EXPECT_THAT(findings, Tells("features[2].linear_pattern.count", "must be a whole number"));
  EXPECT_THAT(findings, Tells("features[3].heat.temperature", "must be greater than 0"));
  EXPECT_THAT(findings, Tells("features[4].draft.angle", "less than 1.2 rad"));
  EXPECT_THAT(findings, Tells("features[4].draft.angle", "(at a = "));
}

// Numbers that go wrong are told with names, references and texts that do, but not what only hangs
// on one of these.
TEST(BadTemplate, TellsNumbersWithAllElse) {
  const auto findings = FindingsOf(
      "parameters { name: 'w' unit: 'm' minimum: nan maximum: 0.2 default_value: 0.1 } "
      "parameters { name: 'n' unit: '1' minimum: 0 maximum: 4 default_value: 2 } "
      "definitions { name: 'never' value: '1 / 0' } definitions { name: 'unread' value: '1 +' } "
      "definitions { name: 'root' value: 'sqrt(0 - 1)' } ",
      "features { name: 's' sketch { profiles { name: 'o' rectangle { width: '0.1 / (2 - 2)' "
      "height: 'w' } } } } "
      "features { name: 't' sketch { profiles { name: 'o' path { start { x: '0' } "
      "segments { name: 'a' to { x: '0' } } } } } } "
      "features { name: 'u' sketch { profiles { name: 'o' circle { radius: 'never' } } } } "
      "features { name: 'x' extrude { sketch: 'nobody' from: '0.1' to: '0.01' } } "
      "features { name: 'y' extrude { sketch: 's' to: '0.1 / n' } } "
      "features { name: 'z' extrude { sketch: 's' to: 'w / 0.1 + unread + never + root' } }");
  EXPECT_THAT(PlacesOf(findings),
              UnorderedElementsAre(
                  "parameters[0]", "definitions[0].value", "definitions[1].value",
                  "definitions[2].value", "features[0].sketch.profiles[0].rectangle.width",
                  "features[1].sketch.profiles[0].path.segments[0]", "features[3].extrude.sketch",
                  "features[3].extrude.to", "features[4].extrude.to"));
  EXPECT_THAT(findings, Tells("definitions[0].value", "divides by zero"));
  EXPECT_THAT(findings, Tells("features[4].extrude.to", "divides by zero (at n = 0)"));
}

TEST(BadTemplate, TellsSketchesThatCannotBeDrawn) {
  const auto path = [](const std::string& segments) {
    return "features { name: 's' sketch { profiles { name: 'o' path { " + segments +
           " } } } } features { name: 'e' extrude { sketch: 's' to: '0.1' } }";
  };
  EXPECT_THAT(FindingsOf("", path("segments { name: 'a' to { x: '1' } } segments { name: 'b' to { "
                                  "x: '1' y: '1' } }")),
              Tells("features[0].sketch.profiles[0].path", "is not closed"));
  EXPECT_THAT(
      FindingsOf("", path("segments { name: 'a' to { x: '1' } round: '0.9' } segments { name: 'b' "
                          "to { x: '1' y: '1' } round: '0.9' } segments { name: 'c' }")),
      Tells("features[0].sketch.profiles[0].path.segments[1]", "do not fit"));
  EXPECT_THAT(
      FindingsOf("", path("segments { name: 'a' to { x: '1' } through { x: '0.5' } } segments { "
                          "name: 'b' to { x: '1' y: '1' } } segments { name: 'c' }")),
      Tells("features[0].sketch.profiles[0].path.segments[0].through", "on a line"));
  EXPECT_THAT(
      FindingsOf("", path("segments { name: 'a' } segments { name: 'b' to { x: '1' y: '1' } } "
                          "segments { name: 'c' }")),
      Tells("features[0].sketch.profiles[0].path.segments[0]", "has no length"));
}

struct Failure {
  std::string features;
  std::string field;
  std::string message;
};

TEST(BadTemplate, KernelRefusalsAreErrorsWithAPlace) {
  const std::vector<Failure> failures = {
      {"features { name: 's' sketch { profiles { name: 'o' path { segments { name: 'a' to { x: '1' "
       "y: '1' } } segments { name: 'b' to { x: '1' } } segments { name: 'c' to { y: '1' } } "
       "segments { name: 'd' } } } } } features { name: 'e' extrude { sketch: 's' to: '1' } }",
       "features[0].sketch.profiles[0]", "crosses itself"},
      {"features { name: 's' sketch { profiles { name: 'o' circle { radius: '1' } } profiles { "
       "name: 'i' hole_of: 'o' circle { center { x: '3' } radius: '1' } } } } features { name: 'e' "
       "extrude { sketch: 's' to: '1' } }",
       "features[0].sketch.profiles[0]", "a hole of it is not inside"},
      {"features { name: 's' sketch { profiles { name: 'o' circle { radius: '1' } } } } features { "
       "name: 'e' revolve { sketch: 's' axis_direction { y: '1' } } }",
       "features[1].revolve.axis_point", "goes through"},
      {BlockText() + "features { name: 'f' fillet { edges: 'block.outline & block.end' radius: "
                     "'0.5' } }",
       "features[2].fillet.radius", "a radius of 0.019 m can be made"},
      {BlockText() + "features { name: 'h' shell { open_faces: 'block.end' thickness: '0.2' } }",
       "features[2]", ""},
      {BlockText() + "features { name: 's' sketch { profiles { name: 'o' rectangle { width: '1' "
                     "height: '1' } } } } features { name: 'e' extrude { sketch: 's' from: '-1' "
                     "to: '1' operation: CUT } }",
       "features[3]", "nothing is left of body 'block'"},
      {BlockText() + "features { name: 's' sketch { profiles { name: 'o' rectangle { width: '0.01' "
                     "height: '1' } } } } features { name: 'e' extrude { sketch: 's' from: '-1' "
                     "to: '1' operation: CUT } }",
       "features", "falls into 2 solids"},
      {BlockText() + "features { name: 'e' extrude { sketch: 'block_sketch' to: '1' } }",
       "features[2]", "body 'e' is left over"},
      {BlockText() + "features { name: 'h' hole { face: 'block.outline' diameter: '0.01' } }",
       "features[2].hole.face", "more than one plane"},
      {BlockText() + "features { name: 'h' hole { face: 'block.end' diameter: '0.01' } } features "
                     "{ name: 'i' hole { face: 'h.wall' diameter: '0.001' } }",
       "features[3].hole.face", "is not plane"},
      {BlockText() + "features { name: 'h' hole { face: 'block.end' diameter: '0.01' "
                     "countersink_diameter: '0.005' } }",
       "features[2].hole.countersink_diameter", "not greater than the diameter"},
      {BlockText() + "features { name: 'p' linear_pattern { feature: 'block' count: '2' } }",
       "features[2].linear_pattern.step", "has no length"},
      {BlockText() + "features { name: 's' sketch { plane { normal { x: '1' } x_axis { x: '1' } } "
                     "profiles { name: 'o' circle { radius: '1' } } } }",
       "features[2].sketch.plane.x_axis", "no length across the normal"},
      {BlockText() +
           "features { name: 'p' sketch { profiles { name: 'w' path { open: true segments "
           "{ name: 'a' to { x: '1' } } } } } } features { name: 'e' sweep { sketch: "
           "'block_sketch' path: 'p' operation: UNITE } }",
       "features[3].sweep.path", "begins along the plane"},
  };
  for (const Failure& failure : failures) {
    const auto model = SolidOf("", failure.features);
    ASSERT_FALSE(model.ok()) << failure.features;
    EXPECT_EQ(model.status().code(), absl::StatusCode::kInvalidArgument) << model.status();
    EXPECT_THAT(DetailOf(model.status()).field, testing::StartsWith(failure.field))
        << model.status();
    EXPECT_THAT(std::string(model.status().message()), HasSubstr(failure.message));
  }
}

TEST(BadParameters, AreToldAtOnce) {
  const auto model = ModelOf(TemplateText(
      Range("a", 0, 1, 0.5) + Range("b", 0, 1, 0.5) + Range("c", 0, 1, 0.5), BlockText()));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto wrong =
      model->Regenerate(Eigen::Vector3d(-0.1, 0.5, std::numeric_limits<double>::quiet_NaN()));
  const auto violations = ViolationsOf(wrong.status());
  ASSERT_EQ(violations.size(), 2U);
  EXPECT_EQ(violations[0].field, "parameters[0]");
  EXPECT_EQ(violations[1].field, "parameters[2]");
  EXPECT_EQ(DetailOf(model->Regenerate(Eigen::VectorXd::Zero(2)).status()).field, "parameters");
}

TEST(CadTemplateCodec, LosesNothing) {
  const std::string text = TemplateText(
      Range("a", 0.1, 1, 0.5) + "definitions { name: 'd' value: 'a / 2' } ",
      BlockText() +
          "features { name: 'r_sketch' sketch { plane { origin { x: 'a' } normal { y: '-1' } "
          "x_axis { x: '1' } } profiles { name: 'p' path { start { x: '0.1' } segments { name: 's' "
          "to { x: '0.2' } through { y: '1' } round: '0' } open: true } } profiles { name: 'q' "
          "hole_of: 'p' polygon { center { x: '1' } radius: 'a' sides: '5' angle: '1' } } } } "
          "features { name: 'r' revolve { sketch: 'r_sketch' axis_point { x: '1' } axis_direction "
          "{ y: '1' } angle: 'pi' operation: INTERSECT body: 'block' } } "
          "features { name: 'w' sweep { sketch: 'a' path: 'b' operation: UNITE } } "
          "features { name: 'b' boolean { operation: CUT body: 'block' tools: 'x' tools: 'y' } } "
          "features { name: 'f' fillet { edges: 'a & b' radius: '1' } } "
          "features { name: 'c' chamfer { edges: 'a & *' distance: '1' } } "
          "features { name: 'd' draft { faces: 'a' neutral: 'b' angle: '0.1' } } "
          "features { name: 's' shell { open_faces: 'a' thickness: '1' } } "
          "features { name: 'h' hole { face: 'a' position { z: '1' } diameter: '1' depth: '2' "
          "counterbore_diameter: '3' counterbore_depth: '4' countersink_diameter: '5' "
          "countersink_angle: '6' } } "
          "features { name: 'l' linear_pattern { feature: 'h' step { x: '1' } count: '2' "
          "second_step { y: '1' } second_count: '3' } } "
          "features { name: 'o' circular_pattern { feature: 'h' axis_point { x: '1' } "
          "axis_direction { x: '1' } count: '4' angle: '5' } } "
          "features { name: 'x' fixed { faces: 'a' } } "
          "features { name: 'y' force { faces: 'a' force { z: '1' } } } "
          "features { name: 'z' pressure { faces: 'a' pressure: '1' } } "
          "features { name: 't' heat { faces: 'a' flux: '1' } } "
          "features { name: 'tt' heat { faces: 'a' temperature: '2' } } "
          "features { name: 'tc' heat { faces: 'a' convection: '3' ambient: '4' } } "
          "features { name: 's' symmetric { faces: 'a' } } "
          "features { name: 'd' displacement { faces: 'a' displacement { y: '0' } } } "
          "features { name: 'g' gravity { acceleration { z: '-9.8' } load_case: 'own' } } "
          "features { name: 'r' rotation { axis_point { x: '1' } angular_velocity { z: '2' } "
          "load_case: 'spin' } } reference_temperature: '293.15'");
  const auto definition = ParseCadTemplateText(text, "test");
  ASSERT_TRUE(definition.ok()) << definition.status();
  const v1::CadTemplate message = ToProto(*definition);
  const auto again = FromProto(message);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(ToProto(*again).SerializeAsString(), message.SerializeAsString());
  EXPECT_THAT(message.DebugString(), HasSubstr("countersink_angle: \"6\""));
}

TEST(CadTemplateCodec, RefusesWhatStructsCannotHold) {
  const auto heat = ParseCadTemplateText(
      "features { name: 'a' heat { flux: '1' temperature: '2' } } "
      "features { name: 'b' heat { flux: '1' ambient: '2' } }",
      "oven");
  EXPECT_THAT(std::string(heat.status().message()),
              AllOf(HasSubstr("features[0].heat"), HasSubstr("features[1].heat.ambient")));
  const auto syntax = ParseCadTemplateText("name: 'x' features { sketh { } }", "wrench");
  EXPECT_EQ(DetailOf(syntax.status()).field, "wrench: line 1, column 22");
  const auto kinds =
      ParseCadTemplateText("features { name: 'a' } features { sketch { profiles { } } }", "x");
  const auto violations = ViolationsOf(kinds.status());
  ASSERT_EQ(violations.size(), 2U);
  EXPECT_EQ(violations[0].field, "features[0]");
  EXPECT_EQ(violations[1].field, "features[1].sketch.profiles[0]");
}

}  // namespace
}  // namespace mortise::cad
