// Cage templates: exact shapes, derivatives, conditions, and everything wrong found with its place.
#include "common/templates/cage/cage_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/mass_properties.h"
#include "common/templates/cage/codec/cage_template_codec.h"
#include "tests/unit/common/templates/cage/cage_texts.h"

namespace mortise::parametric {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;

CageTemplate Block(const std::string& text = kBlock) {
  auto definition = ParseCageTemplateText(text, "block");
  EXPECT_TRUE(definition.ok()) << definition.status();
  return definition.ok() ? *std::move(definition) : CageTemplate();
}

CageModel BlockModel(const std::string& text = kBlock) {
  auto model = CageModel::Create(Block(text));
  EXPECT_TRUE(model.ok()) << model.status();
  return *std::move(model);
}

TEST(CageModel, IsAsWrittenAtTheDefaults) {
  const CageModel model = BlockModel();
  const auto design = model.Evaluate(model.Defaults());
  ASSERT_TRUE(design.ok()) << design.status();
  const Eigen::Matrix3Xd& written = model.definition().surface.vertices;
  EXPECT_LT((design->surface.vertices - written).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(design->surface.triangles.cols(), 12);
  EXPECT_THAT(design->face_names, testing::ElementsAre("bottom", "top", "sides"));
  EXPECT_EQ(design->triangle_face(1), 0);
  EXPECT_EQ(design->triangle_face(2), 1);
  EXPECT_EQ(design->triangle_face(11), 2);
}

TEST(CageModel, FollowsAnAffineCageExactly) {
  const CageModel model = BlockModel();
  const Eigen::Vector3d q(0.37, 0.13, -0.06);
  const auto design = model.Evaluate(q);
  ASSERT_TRUE(design.ok()) << design.status();
  const Eigen::Matrix3Xd& written = model.definition().surface.vertices;
  for (Eigen::Index v = 0; v < written.cols(); ++v) {
    const Eigen::Vector3d at = written.col(v);
    const Eigen::Vector3d wanted(at.x() * q(0) / 0.2 + q(2) * at.z() / 0.2, at.y(),
                                 at.z() * q(1) / 0.2);
    EXPECT_LT((design->surface.vertices.col(v) - wanted).norm(), 1e-13) << v;
  }
  const auto volume = model.Volume(q);
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_NEAR(volume->value, q(0) / 2 * 0.1 * q(1) / 2, 1e-15);
  EXPECT_NEAR(volume->gradient(0), 0.05 * q(1) / 2, 1e-13);
  EXPECT_NEAR(volume->gradient(1), 0.05 * q(0) / 2, 1e-13);
  EXPECT_NEAR(volume->gradient(2), 0, 1e-13);
  const auto jacobian = model.Jacobian(q);
  ASSERT_TRUE(jacobian.ok()) << jacobian.status();
  ASSERT_EQ(jacobian->rows(), 24);
  EXPECT_NEAR((*jacobian)(3 * 5 + 0, 0), 0.05 / 0.2, 1e-13);  // x of vertex 5 by width
  EXPECT_NEAR((*jacobian)(3 * 5 + 2, 1), 0.1 / 0.2, 1e-13);   // z by height
  EXPECT_NEAR((*jacobian)(3 * 5 + 0, 2), 0.1 / 0.2, 1e-13);   // x by lean
  EXPECT_NEAR((*jacobian)(3 * 5 + 1, 0), 0, 1e-15);
}

TEST(CageModel, EvaluatesConditions) {
  const CageModel model = BlockModel();
  const auto design = model.Evaluate(Eigen::Vector3d(0.2, 0.25, 0.05));
  ASSERT_TRUE(design.ok()) << design.status();
  ASSERT_EQ(design->conditions.size(), 5u);
  const FaceCondition &held = design->conditions[0], &pull = design->conditions[1],
                      &wind = design->conditions[2], &sun = design->conditions[3],
                      &cold = design->conditions[4];
  EXPECT_EQ(held.kind, BoundaryConditionKind::kFixed);
  EXPECT_THAT(held.faces, testing::ElementsAre(0));
  EXPECT_EQ(pull.kind, BoundaryConditionKind::kForce);
  EXPECT_LT((pull.force - Eigen::Vector3d(5, 0, 5)).norm(), 1e-12);
  EXPECT_THAT(wind.faces, testing::ElementsAre(1, 2));
  EXPECT_DOUBLE_EQ(wind.pressure, 250);
  EXPECT_EQ(sun.kind, BoundaryConditionKind::kHeatFlux);
  EXPECT_DOUBLE_EQ(sun.heat_flux, 800);
  EXPECT_EQ(cold.kind, BoundaryConditionKind::kTemperature);
  EXPECT_DOUBLE_EQ(cold.temperature, 281);
}

TEST(CageModel, MayReachOutOfItsCage) {
  // The box is moved sideways, half of it out of the cage.
  CageTemplate definition = Block();
  definition.surface.vertices.row(0).array() += 0.1;
  const auto model = CageModel::Create(definition);
  ASSERT_TRUE(model.ok()) << model.status();
  const auto design = model->Evaluate(Eigen::Vector3d(0.3, 0.2, 0.02));
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_NEAR(design->surface.vertices(0, 6), 0.15 * 1.5 + 0.01, 1e-13);
}

TEST(CageModel, NamesEveryParameterOutOfItsRange) {
  const CageModel model = BlockModel();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto status = model.Evaluate(Eigen::Vector3d(0.5, nan, 0)).status();
  const auto violations = ViolationsOf(status);
  ASSERT_EQ(violations.size(), 2u) << status;
  EXPECT_EQ(violations[0].field, "parameters[0]");
  EXPECT_EQ(violations[1].field, "parameters[1]");
  EXPECT_EQ(DetailOf(model.Volume(Eigen::Vector2d(0.2, 0.2)).status()).field, "parameters");
  EXPECT_EQ(DetailOf(model.Jacobian(Eigen::Vector3d(0.2, 0.2, 1)).status()).field, "parameters[2]");
}

TEST(CageModel, SaysWhereExpressionsFailAtSomeParametersOnly) {
  const CageModel model = BlockModel(Replaced(kBlock, "x: \"left\" y: \"-0.1\"",
                                              "x: \"left\" y: \"-0.1 + 0 / (width - 0.2345)\""));
  const auto status = model.Evaluate(Eigen::Vector3d(0.2345, 0.2, 0)).status();
  EXPECT_EQ(DetailOf(status).field, "cage.vertices[4].y") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("divides by zero"));
}

TEST(CageModel, RefusesShapesThatCrossThemselvesAtSomeParametersOnly) {
  // In a narrow range of widths one corner of the cage falls far below the others.
  const CageModel model = BlockModel(Replaced(
      kBlock, "z: \"height\"", "z: \"height - 1000 * max(0, 0.0005 - abs(width - 0.2345))\""));
  const auto status = model.Evaluate(Eigen::Vector3d(0.2345, 0.2, 0)).status();
  EXPECT_EQ(DetailOf(status).field, "surface") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("crosses itself at ("));
  EXPECT_THAT(std::string(status.message()), HasSubstr("width = 0.2345, height = 0.2, lean = 0"));
  EXPECT_TRUE(model.Evaluate(Eigen::Vector3d(0.24, 0.2, 0)).ok());
}

TEST(CageModel, IsRefusedIfTheShapeFailsAtPartsOfTheBox) {
  const auto findings = ValidateCageTemplate(
      Block(Replaced(kBlock, "minimum: -0.1 maximum: 0.1", "minimum: -0.1 maximum: 2")));
  EXPECT_TRUE(findings.empty()) << findings[0].field << ": " << findings[0].message;  // sheared
  const auto turned = ValidateCageTemplate(
      Block(Replaced(kBlock, "minimum: 0.1 maximum: 0.4", "minimum: -0.1 maximum: 0.4")));
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_EQ(turned[0].field, "surface");
  EXPECT_THAT(turned[0].message, HasSubstr("turns inside out (at width = -0.1"));
}

// Each change of the block's text, and the finding that it must give.
struct Fault {
  const char* name;
  const char* from;
  const char* to;
  const char* field;
  const char* message;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class CageFaultTest : public testing::TestWithParam<Fault> {};

TEST_P(CageFaultTest, IsFoundWithItsPlace) {
  const Fault& fault = GetParam();
  const CageTemplate definition = Block(Replaced(kBlock, fault.from, fault.to));
  const std::vector<FieldViolation> findings = ValidateCageTemplate(definition);
  std::string listed;
  for (const FieldViolation& finding : findings) {
    absl::StrAppend(&listed, finding.field, ": ", finding.message, "\n");
  }
  EXPECT_THAT(findings,
              Contains(testing::AllOf(Field(&FieldViolation::field, fault.field),
                                      Field(&FieldViolation::message, HasSubstr(fault.message)))))
      << listed;
  EXPECT_FALSE(CageModel::Create(definition).ok());
}

INSTANTIATE_TEST_SUITE_P(
    All, CageFaultTest,
    testing::Values(
        Fault{"Name", "templates/block", "block", "name", "templates/"},
        Fault{"Material", "materials/beech", "", "material", "materials/"},
        Fault{"ParameterName", "name: \"width\"", "name: \"2nd\"", "parameters[0].name", "letter"},
        Fault{"ReservedName", "name: \"half\"", "name: \"sqrt\"", "definitions[0].name", "word"},
        Fault{"NameTwice", "name: \"half\"", "name: \"lean\"", "definitions[0].name", "twice"},
        Fault{"Unit", "unit: \"m\"", "", "parameters[0].unit", "missing"},
        Fault{"CrossedRange", "minimum: 0.1", "minimum: 0.5", "parameters[0].maximum", "greater"},
        Fault{"Default", "default_value: 0.2", "default_value: 2", "parameters[0].default_value",
              "outside"},
        Fault{"RangeNotFinite", "maximum: 0.4", "maximum: inf", "parameters[0]", "finite"},
        Fault{"UnknownName", "x: \"-half\"", "x: \"-quarter\"", "cage.vertices[0].x", "quarter"},
        Fault{"LaterDefinition", "width / 2", "right", "definitions[0].value", "right"},
        Fault{"Unreadable", "z: \"height\"", "z: \"height +\"", "cage.vertices[4].z", "height +"},
        Fault{"DividesByZero", "width / 2", "width / (lean - lean)", "definitions[0].value",
              "divides by zero"},
        Fault{"TooFar", "y: \"-0.1\"", "y: \"-1e4\"", "cage.vertices[0].y", "1 km"},
        Fault{"VertexNotFinite", "-0.05, -0.05, 0,", "nan, -0.05, 0,", "surface.vertices",
              "finite"},
        Fault{"VertexTooFar", "-0.05, -0.05, 0,", "-5e4, -0.05, 0,", "surface.vertices", "1 km"},
        Fault{"VertexUnused", "0.05, 0.05, 0.1]", "0.05, 0.05, 0.1,  1, 1, 1]", "surface.vertices",
              "vertex 8 belongs to no triangle"},
        Fault{"NoSuchVertex", "0, 2, 1,  0, 3, 2]", "0, 2, 1,  0, 3, 9]",
              "surface.faces[0].triangles", "triangle 1"},
        Fault{"OpenSurface", "0, 2, 1,  0, 3, 2]", "0, 2, 1]", "surface", "open"},
        Fault{"FlippedTriangle", "0, 2, 1,  0, 3, 2]", "0, 2, 1,  0, 2, 3]", "surface",
              "opposite ways"},
        Fault{"CrossingSurface", "0.05, 0.05, 0.1,  -0.05", "0.05, 0.05, -0.03,  -0.05", "surface",
              "cross"},
        Fault{"FaceTwice", "name: \"top\"", "name: \"bottom\"", "surface.faces[1].name", "twice"},
        Fault{"EmptyFace", "[4, 5, 6,  4, 6, 7]", "[]", "surface.faces[1].triangles", "missing"},
        Fault{"OpenCage", "              1, 2, 6,  ", "", "cage", "open"},
        Fault{"CageOutOfRange", "triangles: [0, 2, 1,  0, 3, 2,  4",
              "triangles: [0, 2, 1,  0, 3, 8,  4", "cage", "does not exist"},
        Fault{"FlatCage", "z: \"height\" }\n  vertices { x: \"right\" y: \"-0.1\" z: \"height\"",
              "z: \"height\" }\n  vertices { x: \"left\" y: \"-0.1\" z: \"height\"", "cage",
              "no area"},
        Fault{"ConditionTwice", "name: \"pull\"", "name: \"held\"", "conditions[1].name", "twice"},
        Fault{"UnknownFace", "faces: \"top\" force", "faces: \"front\" force",
              "conditions[1].faces[0]", "front"},
        Fault{"NoFaces", "fixed { faces: \"bottom\" }", "fixed { }", "conditions[0].faces",
              "at least 1"},
        Fault{"NoPressure", "pressure: \"1000 * height\"", "", "conditions[2].pressure.pressure",
              ""},
        Fault{"Freezing", "280 + 10 * half", "half - width", "conditions[4].heat.temperature",
              "greater than 0"}),
    [](const auto& fault) { return fault.param.name; });

TEST(CageModel, FindsAllFaultsAtOnce) {
  std::string text = kBlock;
  text = Replaced(text, "materials/beech", "beech");
  text = Replaced(text, "width / 2", "width /");
  text = Replaced(text, "0, 2, 1,  0, 3, 2]", "0, 2, 1]");
  text = Replaced(text, "y: \"0.1\" z: \"height\"", "y: \"depth\" z: \"height\"");
  text = Replaced(text, "faces: \"top\" flux", "faces: \"roof\" flux");
  const auto status = CageModel::Create(Block(text)).status();
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  for (const char* field : {"material", "definitions[0].value", "surface", "cage.vertices[6].y",
                            "conditions[3].faces[0]"}) {
    EXPECT_THAT(fields, Contains(field)) << status;
  }
}

TEST(CageModel, RefusesWhatIsTooLarge) {
  const auto fields_of = [](const CageTemplate& definition) {
    std::vector<std::string> fields;
    for (const FieldViolation& finding : ValidateCageTemplate(definition)) {
      fields.push_back(finding.field);
    }
    return fields;
  };
  CageTemplate definition = Block();
  definition.parameters.resize(65, definition.parameters[0]);
  definition.definitions.resize(501, definition.definitions[0]);
  definition.surface.vertices.conservativeResize(3, 5001);
  definition.cage.vertices.resize(251);
  definition.conditions.resize(501, definition.conditions[0]);
  EXPECT_THAT(fields_of(definition),
              testing::ElementsAre("parameters", "definitions", "surface.vertices", "cage.vertices",
                                   "conditions"));
  definition = Block();
  definition.surface.faces[0].triangles.setZero(3, 10'001);
  EXPECT_THAT(fields_of(definition), testing::ElementsAre("surface.faces[*].triangles"));
  EXPECT_THAT(fields_of({}), testing::ElementsAre("parameters", "surface.vertices", "surface.faces",
                                                  "cage.vertices", "cage.triangles"));
}

TEST(CageTemplateCodec, LosesNothing) {
  const CageTemplate definition = Block();
  const v1::CageTemplate message = ToProto(definition);
  const auto again = FromProto(message);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(ToProto(*again).SerializeAsString(), message.SerializeAsString());
  EXPECT_EQ(again->surface.vertices, definition.surface.vertices);
  EXPECT_EQ(again->surface.faces[2].triangles, definition.surface.faces[2].triangles);
  EXPECT_EQ(again->cage.vertices[5].x, "right");
  EXPECT_EQ(again->conditions[4].components.at(0), "280 + 10 * half");
}

TEST(CageTemplateCodec, NamesWhatCannotBeRead) {
  std::string text = kBlock;
  text = Replaced(text, "-0.05, -0.05, 0,", "-0.05, 0,");
  text = Replaced(text, "[4, 5, 6,  4, 6, 7]", "[4, 5, 6,  4, 6]");
  text = Replaced(text, "fixed { faces: \"bottom\" }", "");
  text = Replaced(text, "flux: \"800\"", "flux: \"800\" temperature: \"300\"");
  const auto status = ParseCageTemplateText(text, "block").status();
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  EXPECT_THAT(fields, testing::ElementsAre("surface.vertices", "surface.faces[1].triangles",
                                           "conditions[0]", "conditions[3].heat"))
      << status;
  const auto syntax = ParseCageTemplateText("cage { vertices { w: 3 } }", "block").status();
  EXPECT_EQ(DetailOf(syntax).field, "block: line 1, column 19") << syntax;
}

}  // namespace
}  // namespace mortise::parametric
