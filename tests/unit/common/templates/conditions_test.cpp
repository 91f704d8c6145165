// Boundary conditions of every kind of template: alike in what they take, say and refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::templates {
namespace {

using parametric::BoundaryConditionKind;
using parametric::EvaluatedBoundaryCondition;
using parametric::EvaluatedDesign;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::SizeIs;

absl::StatusOr<EvaluatedDesign> DesignOf(v1::TemplateBundle bundle, double length = 0.4) {
  MORTISE_RETURN_IF_ERROR(FillAndCheck(bundle, Trial::kDefaults));
  MORTISE_ASSIGN_OR_RETURN(const auto compiled, Compile(bundle));
  return compiled->Evaluate(Eigen::VectorXd::Constant(1, length));
}

// Every kind of condition, as parts and assemblies write them.
const char* const kOfParts =
    "boundary_conditions { name: 'guide' kind: SYMMETRIC part: 'bar' face: 'y_min' } "
    "boundary_conditions { name: 'moved' kind: DISPLACEMENT part: 'bar' face: 'x_min' "
    "components: '0' components: '' components: 'length / 1000' } "
    "boundary_conditions { name: 'push' kind: PRESSURE part: 'bar' face: 'x_max' "
    "components: '1000 * length' load_case: 'pushed' } "
    "boundary_conditions { name: 'weight' kind: GRAVITY components: '0' components: '0' "
    "components: '-9.8' } "
    "boundary_conditions { name: 'spin' kind: ROTATION components: '0' components: '0.02' "
    "components: '0.02' components: '10 / length' components: '0' components: '0' "
    "load_case: 'spun' } "
    "boundary_conditions { name: 'sun' kind: HEAT_FLUX part: 'bar' face: 'z_max' "
    "components: '200 / length' } "
    "boundary_conditions { name: 'stove' kind: TEMPERATURE part: 'bar' face: 'x_max' "
    "components: '300 + 100 * length' } "
    "boundary_conditions { name: 'air' kind: CONVECTION part: 'bar' face: 'z_min' "
    "components: '20 * length' components: '293.15' } reference_temperature: '280 + 10 * length'";

// The same, in the words of lists of features and of cages; `$k` names a face.
std::string OfSolids(const std::string& list, const std::map<std::string, std::string>& faces) {
  std::string text = absl::StrCat(
      list, " { name: 'guide' symmetric { faces: '$y_min' } } ", list,
      " { name: 'moved' displacement { faces: '$x_min' displacement { x: '0' z: 'length / 1000' } "
      "} "
      "} ",
      list, " { name: 'push' pressure { faces: '$x_max' pressure: '1000 * length' ",
      "load_case: 'pushed' } } ", list,
      " { name: 'weight' gravity { acceleration { z: '-9.8' } } } ", list,
      " { name: 'spin' rotation { axis_point { y: '0.02' z: '0.02' } ",
      "angular_velocity { x: '10 / length' } load_case: 'spun' } } ", list,
      " { name: 'sun' heat { faces: '$z_max' flux: '200 / length' } } ", list,
      " { name: 'stove' heat { faces: '$x_max' temperature: '300 + 100 * length' } } ", list,
      " { name: 'air' heat { faces: '$z_min' convection: '20 * length' ambient: '293.15' } } ",
      "reference_temperature: '280 + 10 * length'");
  for (const auto& [face, reference] : faces) {
    for (std::size_t at = text.find("$" + face); at != text.npos; at = text.find("$" + face)) {
      text.replace(at, face.size() + 1, reference);
    }
  }
  return text;
}

// The faces of each bar in the words of its kind.
const std::map<std::string, std::string>& CageFaces() {
  static const std::map<std::string, std::string> faces{{"x_min", "x_min"},
                                                        {"x_max", "x_max"},
                                                        {"y_min", "y_min"},
                                                        {"z_min", "z_min"},
                                                        {"z_max", "z_max"}};
  return faces;
}
const std::map<std::string, std::string>& CadFaces() {
  static const std::map<std::string, std::string> faces{{"x_min", "bar.start"},
                                                        {"x_max", "bar.end"},
                                                        {"y_min", "bar.section.bottom"},
                                                        {"z_min", "bar.section.left"},
                                                        {"z_max", "bar.section.right"}};
  return faces;
}

std::map<std::string, v1::TemplateBundle> AllKinds() {
  return {{"parts", PartsBar(kOfParts)},
          {"assembly", AssemblyBar(kOfParts)},
          {"cad", CadBar(OfSolids("features", CadFaces()))},
          {"cage", CageBar(OfSolids("conditions", CageFaces()))}};
}

TEST(Conditions, AreTheSameInEveryKindOfTemplate) {
  for (const auto& [kind, bundle] : AllKinds()) {
    SCOPED_TRACE(kind);
    const auto design = DesignOf(bundle, 0.5);
    ASSERT_TRUE(design.ok()) << design.status();
    const auto& all = design->boundary_conditions;
    ASSERT_THAT(all, SizeIs(8));
    EXPECT_EQ(all[0].kind, BoundaryConditionKind::kSymmetric);
    EXPECT_EQ(all[1].displacement[0], 0.0);
    EXPECT_FALSE(all[1].displacement[1].has_value());
    EXPECT_DOUBLE_EQ(all[1].displacement[2].value(), 0.0005);
    EXPECT_DOUBLE_EQ(all[2].pressure, 500);
    EXPECT_EQ(all[2].load_case, "pushed");
    EXPECT_EQ(all[3].acceleration, Eigen::Vector3d(0, 0, -9.8));
    EXPECT_TRUE(all[3].part.empty() && all[3].face.empty() && all[3].load_case.empty());
    EXPECT_EQ(all[4].axis_point, Eigen::Vector3d(0, 0.02, 0.02));
    EXPECT_EQ(all[4].angular_velocity, Eigen::Vector3d(20, 0, 0));
    EXPECT_EQ(all[4].load_case, "spun");
    EXPECT_DOUBLE_EQ(all[5].heat_flux, 400);
    EXPECT_DOUBLE_EQ(all[6].temperature, 350);
    EXPECT_DOUBLE_EQ(all[7].coefficient, 10);
    EXPECT_DOUBLE_EQ(all[7].temperature, 293.15);
    EXPECT_DOUBLE_EQ(design->reference_temperature.value(), 285);
    for (const EvaluatedBoundaryCondition& condition : all) {
      EXPECT_EQ(condition.part.empty(), !parametric::ActsOnFace(condition.kind));
    }
    // As files and other services have it.
    const auto again = parametric::FromProto(parametric::ToProto(*design));
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_EQ(parametric::ToProto(*again).SerializeAsString(),
              parametric::ToProto(*design).SerializeAsString());
    EXPECT_EQ(again->boundary_conditions[1].displacement, all[1].displacement);
    EXPECT_EQ(again->reference_temperature, design->reference_temperature);
  }
}

std::map<std::string, std::string> FindingsOf(const absl::Status& status) {
  std::map<std::string, std::string> findings;
  for (const FieldViolation& violation : ViolationsOf(status)) {
    findings[violation.field] = violation.message;
  }
  if (findings.empty()) findings[DetailOf(status).field] = std::string(status.message());
  return findings;
}

// All at once, each by its field.
TEST(Conditions, WhatIsWrongIsToldByField) {
  const std::string faults =
      "boundary_conditions { name: 'a' kind: FIXED part: 'bar' face: 'x_min' load_case: 'own' } "
      "boundary_conditions { name: 'b' kind: DISPLACEMENT part: 'bar' face: 'x_min' "
      "components: '' components: '' components: '' } "
      "boundary_conditions { name: 'c' kind: GRAVITY part: 'bar' face: 'x_min' components: '0' "
      "components: '0' components: '1' } "
      "boundary_conditions { name: 'd' kind: CONVECTION part: 'bar' face: 'x_min' "
      "components: '20' } "
      "boundary_conditions { name: 'e' kind: PRESSURE part: 'bar' face: 'x_min' components: '1' "
      "load_case: 'two words' } "
      "boundary_conditions { name: 'f' kind: TEMPERATURE part: 'bar' face: 'nowhere' "
      "components: 'lenght' } reference_temperature: '1 +'";
  for (const v1::TemplateBundle& bundle : {PartsBar(faults), AssemblyBar(faults)}) {
    const auto findings = FindingsOf(DesignOf(bundle).status());
    for (const char* field : {"boundary_conditions[0].load_case", "boundary_conditions[1]",
                              "boundary_conditions[2].part", "boundary_conditions[2].face",
                              "boundary_conditions[3].components",
                              "boundary_conditions[4].load_case", "boundary_conditions[5].face",
                              "boundary_conditions[5].components[0]", "reference_temperature"}) {
      EXPECT_EQ(findings.count(field), 1u) << field;
    }
    EXPECT_EQ(findings.size(), 9u);
  }
}

TEST(Conditions, WhatIsWrongInSolidsIsToldByField) {
  const auto faults = [](const std::string& list, const std::string& face) {
    return absl::StrCat(
        list, " { name: 'a' displacement { faces: '", face, "' displacement { } } } ", list,
        " { name: 'b' pressure { faces: '", face, "' pressure: '1' load_case: 'two words' } } ",
        list, " { name: 'c' heat { faces: '", face, "' convection: '20' } } ", list,
        " { name: 'd' gravity { acceleration { x: 'lenght' } } } reference_temperature: '1 +'");
  };
  const auto cad = FindingsOf(DesignOf(CadBar(faults("features", "bar.start"))).status());
  for (const char* field :
       {"cad.features[2]", "cad.features[3].load_case", "cad.features[4].heat.ambient",
        "cad.features[5].gravity.acceleration.x", "cad.reference_temperature"}) {
    EXPECT_EQ(cad.count(field), 1u) << field;
  }
  EXPECT_EQ(cad.size(), 5u);
  const auto cage = FindingsOf(DesignOf(CageBar(faults("conditions", "x_min"))).status());
  for (const char* field :
       {"cage.conditions[0]", "cage.conditions[1].load_case", "cage.conditions[2].heat.ambient",
        "cage.conditions[3].gravity.acceleration.x", "cage.reference_temperature"}) {
    EXPECT_EQ(cage.count(field), 1u) << field;
  }
  EXPECT_EQ(cage.size(), 5u);
}

TEST(Conditions, MeanSomethingTogether) {
  const std::string held =
      "boundary_conditions { name: 'h' kind: FIXED part: 'bar' face: 'x_min' } ";
  EXPECT_THAT(FindingsOf(DesignOf(PartsBar(held + "reference_temperature: '293'")).status()),
              Contains(Pair("reference_temperature", HasSubstr("no condition of heat"))));
  std::string spins, many;
  for (int i = 0; i < 21; ++i) {
    absl::StrAppend(&many, "boundary_conditions { name: 'p", i,
                    "' kind: PRESSURE part: 'bar' face: 'x_max' components: '1' load_case: 'c", i,
                    "' } ");
  }
  for (const char* load_case : {"", "spun"}) {
    absl::StrAppend(&spins, "boundary_conditions { name: 's", load_case,
                    "' kind: ROTATION components: '0' components: '0' components: '0' "
                    "components: '0' components: '0' components: '1' load_case: '",
                    load_case, "' } ");
  }
  for (auto* const make : {&PartsBar, &AssemblyBar}) {
    EXPECT_THAT(FindingsOf(DesignOf(make(held + spins, {})).status()),
                Contains(Pair("boundary_conditions", HasSubstr("two rotations"))));
    EXPECT_THAT(FindingsOf(DesignOf(make(held + many, {})).status()),
                Contains(Pair("boundary_conditions", HasSubstr("21 load cases"))));
  }
}

// Numbers that are right at the defaults, but not everywhere, are failures of the designs there.
TEST(Conditions, OfADesignThatCannotBeAreToldByName) {
  const std::string of_parts =
      "boundary_conditions { name: 'air' kind: CONVECTION part: 'bar' face: 'z_min' "
      "components: '$0' components: '293.15' } ";
  const std::string of_solids = "heat { faces: '$1' convection: '$0' ambient: '293.15' } } ";
  const auto with = [](std::string text, const std::string& expression, const std::string& face) {
    text.replace(text.find("$0"), 2, expression);
    if (const auto at = text.find("$1"); at != text.npos) text.replace(at, 2, face);
    return text;
  };
  for (const std::string expression : {"sqrt(length - 0.3)", "length - 0.3"}) {
    SCOPED_TRACE(expression);
    const std::map<std::string, v1::TemplateBundle> kinds{
        {"boundary_conditions[0].components[0]", AssemblyBar(with(of_parts, expression, ""))},
        {"features[2].heat.convection",
         CadBar("features { name: 'air' " + with(of_solids, expression, "bar.start"))},
        {"conditions[0].heat.convection",
         CageBar("conditions { name: 'air' " + with(of_solids, expression, "x_min"))}};
    for (const auto& [field, bundle] : kinds) {
      const auto findings = FindingsOf(DesignOf(bundle, 0.25).status());
      ASSERT_FALSE(findings.empty());
      EXPECT_THAT(findings.begin()->first, HasSubstr(field));
      EXPECT_THAT(findings.begin()->second, HasSubstr("'air'"));
    }
    // Those of parts are tried at all corners when the template is made.
    EXPECT_THAT(FindingsOf(DesignOf(PartsBar(with(of_parts, expression, ""))).status()),
                Contains(Pair("boundary_conditions[0].components[0]", HasSubstr("'air'"))));
  }
}

}  // namespace
}  // namespace mortise::templates
