// Choices and what is absent in templates of all kinds: features that are not made, conditions that
// do not act, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/conditioned_bars.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

using parametric::EvaluatedDesign;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Function = std::shared_ptr<const Template>;

constexpr char kStyle[] =
    "parameters { name: 'style' choices: 'plain' choices: 'drilled' choices: 'worn' } ";

// A bar of features with a bore and rounded edges, each of one style only, and a load of the third.
v1::TemplateBundle StyledBar(const std::string& more = "") {
  return CadBar(absl::StrCat(kStyle,
                             "features { name: 'bore' present: \"style == 'drilled'\" hole { "
                             "face: 'bar.section.top' position { x: 'length / 2' y: '0.02' } "
                             "diameter: \"if(style == 'drilled', 0.008, 0)\" } } "
                             "features { name: 'round' present: \"style != 'plain'\" fillet { "
                             "edges: 'bar.section.bottom & bar.section.left' radius: '0.005' } } "
                             "features { name: 'held' fixed { faces: 'bar.start' } } "
                             "features { name: 'pull' present: \"style == 'worn'\" force { "
                             "faces: 'bar.end' force { x: '10' } } } ",
                             more));
}

Function Compiled(v1::TemplateBundle bundle) {
  const absl::Status filled = FillAndCheck(bundle, Trial::kThorough);
  EXPECT_TRUE(filled.ok()) << filled;
  absl::StatusOr<Function> compiled = Compile(bundle);
  EXPECT_TRUE(compiled.ok()) << compiled.status();
  return compiled.ok() ? *std::move(compiled) : nullptr;
}

EvaluatedDesign At(const Function& function, const std::string& style) {
  const auto q = parametric::CompleteParameters(function->parameters(), {{"style", 0, style}});
  EXPECT_TRUE(q.ok()) << q.status();
  auto design = function->Evaluate(*q);
  EXPECT_TRUE(design.ok()) << design.status();
  const auto structure = function->StructureAt(*q);
  EXPECT_TRUE(structure.ok()) << structure.status();
  EXPECT_EQ(*structure, *design->structure);
  return *std::move(design);
}

std::vector<std::string> ConditionsOf(const EvaluatedDesign& design) {
  std::vector<std::string> names;
  for (const auto& condition : design.boundary_conditions) names.push_back(condition.name);
  return names;
}

// The findings of an import, "field: message" each.
std::vector<std::string> FindingsOf(v1::TemplateBundle bundle) {
  const absl::Status status = FillAndCheck(bundle, Trial::kThorough);
  std::vector<std::string> findings;
  for (const FieldViolation& violation : AllViolationsOf(status)) {
    findings.push_back(absl::StrCat(violation.field, ": ", violation.message));
  }
  return findings;
}

TEST(Presence, FeaturesAreMadeWhereTheirConditionHolds) {
  const Function bar = Compiled(StyledBar());
  ASSERT_NE(bar, nullptr);
  EXPECT_TRUE(bar->MayLeaveOut());
  const EvaluatedDesign plain = At(bar, "plain");
  const EvaluatedDesign drilled = At(bar, "drilled");
  const EvaluatedDesign worn = At(bar, "worn");
  const double whole = 0.4 * 0.04 * 0.04;
  const double corner = 0.4 * 0.005 * 0.005 * (1 - M_PI / 4);
  EXPECT_NEAR(plain.parts[0].volume, whole, 1e-9);
  EXPECT_NEAR(worn.parts[0].volume, whole - corner, 1e-9);
  EXPECT_NEAR(drilled.parts[0].volume, whole - corner - M_PI * 0.004 * 0.004 * 0.04, 1e-8);
  EXPECT_THAT(plain.structure->absent_features, ElementsAre("bore", "round", "pull"));
  EXPECT_THAT(drilled.structure->absent_features, ElementsAre("pull"));
  EXPECT_THAT(worn.structure->absent_features, ElementsAre("bore"));
  EXPECT_THAT(ConditionsOf(plain), ElementsAre("held"));
  EXPECT_THAT(ConditionsOf(worn), ElementsAre("held", "pull"));
  EXPECT_EQ(Describe(*worn.structure), "style = worn, without bore");
}

// The bore has a diameter only where there is one.
TEST(Presence, NumbersOfAbsentFeaturesAreNotLookedAt) {
  const Function bar = Compiled(StyledBar());
  ASSERT_NE(bar, nullptr);
  v1::TemplateBundle always = StyledBar();
  for (v1::Feature& feature : *always.mutable_template_()->mutable_cad()->mutable_features()) {
    if (feature.name() == "bore") feature.clear_present();
  }
  EXPECT_THAT(FindingsOf(always), ElementsAre(HasSubstr("cad.features[2].hole.diameter")));
}

TEST(Presence, FeaturesThatOthersNeedAreAlwaysThere) {
  const auto refused = [](const std::string& name) {
    v1::TemplateBundle bundle = StyledBar(
        "features { name: 'row' linear_pattern { feature: 'bore' step { x: '0.02' } count: '2' } "
        "}");
    auto& features = *bundle.mutable_template_()->mutable_cad()->mutable_features();
    for (v1::Feature& feature : features) {
      if (feature.name() == name) feature.set_present("style == 'worn'");
    }
    return FindingsOf(bundle);
  };
  EXPECT_THAT(refused("sketch"),
              ::testing::Contains(HasSubstr("features[0].present: does not go")));
  EXPECT_THAT(refused("bar"), ::testing::Contains(HasSubstr("features[1].present: does not go")));
  EXPECT_THAT(refused("bore"), ::testing::Contains(HasSubstr("'bore' may be absent, and so")));
}

TEST(Presence, ConditionsThatAreNone) {
  const auto present = [](const std::string& text) {
    v1::TemplateBundle bundle = StyledBar();
    bundle.mutable_template_()->mutable_cad()->mutable_features(3)->set_present(text);
    return FindingsOf(bundle);
  };
  EXPECT_THAT(present("1"), ::testing::Contains(HasSubstr("features[3].present: column 1")));
  EXPECT_THAT(present("style == 'bent'"), ::testing::Contains(HasSubstr("has no value 'bent'")));
  EXPECT_THAT(present("sqrt(length - 0.3) > 0"), ::testing::Contains(HasSubstr("no finite value")));
}

// Only where the bore is does its wall have a face.
TEST(Presence, WhatRefersToAnAbsentFeatureFailsThere) {
  EXPECT_THAT(FindingsOf(StyledBar("features { name: 'push' pressure { faces: 'bore.wall' "
                                   "pressure: '1' } }")),
              ::testing::Contains(HasSubstr("features[6]")));
  EXPECT_THAT(FindingsOf(StyledBar("features { name: 'push' present: \"style == 'drilled'\" "
                                   "pressure { faces: 'bore.wall' pressure: '1' } }")),
              IsEmpty());
}

TEST(Presence, ConditionsOfAssembliesActWhereTheyArePresent) {
  const Function bar = Compiled(AssemblyBar(
      "boundary_conditions { name: 'held' kind: FIXED part: 'bar' face: 'x_min' } "
      "boundary_conditions { name: 'long' kind: FORCE part: 'bar' face: 'x_max' components: '1' "
      "components: '0' components: '1 / (length - 0.2)' present: 'length > 0.3' }"));
  ASSERT_NE(bar, nullptr);
  const auto at = [&](double length) {
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, length);
    auto design = bar->Evaluate(q);
    EXPECT_TRUE(design.ok()) << design.status();
    EXPECT_EQ(*bar->StructureAt(q), *design->structure);
    return *std::move(design);
  };
  EXPECT_THAT(ConditionsOf(at(0.2)), ElementsAre("held"));
  EXPECT_THAT(at(0.2).structure->absent_conditions, ElementsAre("long"));
  EXPECT_THAT(ConditionsOf(at(0.4)), ElementsAre("held", "long"));
}

TEST(Presence, ConditionsOfCagesActWhereTheyArePresent) {
  v1::TemplateBundle bundle = CageBar(
      "conditions { name: 'held' fixed { faces: 'x_min' } } "
      "conditions { name: 'push' present: \"style == 'worn'\" pressure { faces: 'x_max' pressure: "
      "'1' } }");
  v1::Parameter& style = *bundle.mutable_template_()->mutable_cage()->add_parameters();
  style.set_name("style");
  style.add_choices("plain");
  style.add_choices("worn");
  const Function bar = Compiled(bundle);
  ASSERT_NE(bar, nullptr);
  EXPECT_THAT(ConditionsOf(At(bar, "plain")), ElementsAre("held"));
  EXPECT_THAT(At(bar, "plain").structure->absent_conditions, ElementsAre("push"));
  EXPECT_THAT(ConditionsOf(At(bar, "worn")), ElementsAre("held", "push"));
  bundle.mutable_template_()->mutable_cage()->mutable_conditions(1)->set_present("length");
  EXPECT_THAT(FindingsOf(bundle), ::testing::Contains(HasSubstr("conditions[1].present")));
}

// What a choice leaves out is filled in, of parts as of the other kinds.
TEST(Presence, ImportFillsInWhatChoicesLeaveOut) {
  for (v1::TemplateBundle bundle : {StyledBar(), PartsBar(kStyle)}) {
    const absl::Status filled = FillAndCheck(bundle, Trial::kDefaults);
    ASSERT_TRUE(filled.ok()) << filled;
    const v1::Parameter& style = bundle.template_().parameters(1);
    EXPECT_EQ(style.unit(), "1");
    EXPECT_EQ(style.maximum(), 2);
    EXPECT_EQ(style.step(), 1);
    EXPECT_EQ(style.choices_size(), 3);
  }
}

// The armchair that ships: all combinations of choices are made, and structures tell them apart.
TEST(Presence, ArmchairIsWithArmrestsOrWithout) {
  const Function armchair = Compiled(ShippedTemplate("templates/armchair"));
  ASSERT_NE(armchair, nullptr);
  std::set<std::string> keys;
  for (const char* arms : {"none", "both"}) {
    for (const char* wood : {"spruce", "beech"}) {
      const auto q = parametric::CompleteParameters(armchair->parameters(),
                                                    {{"armrests", 0, arms}, {"wood", 0, wood}});
      ASSERT_TRUE(q.ok()) << q.status();
      const auto design = armchair->Evaluate(*q);
      ASSERT_TRUE(design.ok()) << design.status();
      EXPECT_EQ(design->parts.size(), std::string(arms) == "both" ? 14U : 12U);
      keys.insert(KeyOf(*design->structure));
      const auto solids = armchair->Solids(*q);
      ASSERT_TRUE(solids.ok()) << solids.status();
      EXPECT_EQ(solids->size(), design->parts.size());
      const auto mass = armchair->Mass(*q);
      ASSERT_TRUE(mass.ok()) << mass.status();
      EXPECT_NEAR(mass->mass, design->mass, 1e-9);
    }
  }
  EXPECT_EQ(keys.size(), 4U);
}

}  // namespace
}  // namespace mortise::templates
