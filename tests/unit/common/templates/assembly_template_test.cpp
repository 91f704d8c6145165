// Assemblies as templates: parameters that can be chosen independently, and designs that have them.
#include "common/templates/assembly_template.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> AssemblyNames() {
  std::vector<std::string> names;
  for (const v1::Assembly& message : ShippedCollection().assemblies) {
    names.push_back(message.name().substr(message.name().find('/') + 1));
  }
  return names;
}

class AssemblyTemplateTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    bundle_ = ShippedAssembly("assemblies/" + GetParam());
    ASSERT_EQ(FillAndCheck(bundle_, Trial::kThorough), absl::OkStatus());
    auto compiled = Compile(bundle_);
    ASSERT_TRUE(compiled.ok()) << compiled.status();
    template_ = *std::move(compiled);
  }

  v1::TemplateBundle bundle_;
  std::shared_ptr<const Template> template_;
};

TEST_P(AssemblyTemplateTest, HasHandlesOfItsOwn) {
  const v1::AssemblyTemplate& message = bundle_.template_().assembly();
  EXPECT_GE(message.handles_size(), 2);
  EXPECT_LE(message.handles_size(), 12);
  EXPECT_EQ(message.handles_size(), static_cast<int>(template_->parameters().size()));
  std::set<std::string> names;
  for (const parametric::Parameter& parameter : template_->parameters()) {
    EXPECT_TRUE(names.insert(parameter.name).second);
    EXPECT_LT(parameter.minimum, parameter.maximum);
    EXPECT_GE(parameter.default_value, parameter.minimum);
    EXPECT_LE(parameter.default_value, parameter.maximum);
  }
  EXPECT_EQ(bundle_.template_().title(), bundle_.assembly().title());
}

TEST_P(AssemblyTemplateTest, IsTheDrawnDesignAtTheDefaults) {
  const auto design = template_->Evaluate(parametric::Defaults(template_->parameters()));
  ASSERT_TRUE(design.ok()) << design.status();
  std::map<std::string, Eigen::Vector3d> drawn;
  EXPECT_GE(design->parts.size(), static_cast<std::size_t>(bundle_.assembly().parts_size()));
  for (const v1::AssemblyPart& part : bundle_.assembly().parts()) {
    const int index = parametric::FindPart(*design, part.name());
    if (index < 0) continue;  // a row is called after its members
    const Eigen::Vector3d position(part.position().x(), part.position().y(), part.position().z());
    EXPECT_LT((design->parts[static_cast<std::size_t>(index)].minimum - position).norm(), 1e-6)
        << part.name();
  }
  EXPECT_GT(design->mass, 0);
}

TEST_P(AssemblyTemplateTest, EachParameterCanBeChangedByItself) {
  const Eigen::VectorXd defaults = parametric::Defaults(template_->parameters());
  for (Eigen::Index i = 0; i < defaults.size(); ++i) {
    const parametric::Parameter& parameter = template_->parameters()[static_cast<std::size_t>(i)];
    bool moves = false;
    for (const double end : {parameter.minimum, parameter.maximum}) {
      Eigen::VectorXd q = defaults;
      q(i) += 0.01 * (end - q(i));
      if (std::abs(q(i) - defaults(i)) < 1e-6) continue;
      const auto design = template_->Evaluate(q);
      if (!design.ok()) continue;
      moves = true;
      EXPECT_EQ(design->parameters[static_cast<std::size_t>(i)].value, q(i));
    }
    EXPECT_TRUE(moves) << parameter.name << " can neither grow nor shrink";
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, AssemblyTemplateTest, ::testing::ValuesIn(AssemblyNames()),
                         [](const auto& chosen) {
                           return absl::StrReplaceAll(chosen.param, {{"-", "_"}});
                         });

v1::TemplateBundle Bookshelf() {
  v1::TemplateBundle bundle = ShippedAssembly("assemblies/bookshelf");
  EXPECT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  return bundle;
}

// Parameters within their ranges and the limits have a design, and none beyond a limit has one.
TEST(AssemblyTemplateChecks, LimitsAmongParametersSayWhatCanBeHadTogether) {
  v1::TemplateBundle bundle = ShippedAssembly("assemblies/step-stool");
  ASSERT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  const auto stool = Compile(bundle).value();
  const auto limits = stool->LimitsAmongParameters();
  ASSERT_TRUE(limits.ok()) << limits.status();
  ASSERT_GT(limits->bounds.size(), 0);
  ASSERT_EQ(limits->normals.cols(), static_cast<Eigen::Index>(stool->parameters().size()));
  int within = 0, beyond = 0;
  for (const Eigen::VectorXd& q : parametric::TrialPoints(stool->parameters(), 300)) {
    const double excess = (limits->normals * q - limits->bounds).maxCoeff();
    if (std::abs(excess) < 1e-6) continue;  // rounding decides
    (excess < 0 ? within : beyond) += 1;
    EXPECT_EQ(stool->Evaluate(q).ok(), excess < 0) << q.transpose();
  }
  EXPECT_GT(within, 5);
  EXPECT_GT(beyond, 50);
}

TEST(AssemblyTemplateChecks, ChosenHandlesAndRangesAreKept) {
  v1::TemplateBundle bundle = Bookshelf();
  v1::AssemblyTemplate& message = *bundle.mutable_template_()->mutable_assembly();
  const v1::AssemblyHandle first = message.handles(0);
  const double drawn = bundle.template_().parameters(0).default_value();
  message.clear_handles();
  *message.add_handles() = first;
  message.mutable_handles(0)->set_parameter("height");
  message.mutable_handles(0)->set_minimum(drawn - 0.01);
  message.mutable_handles(0)->set_maximum(drawn + 0.01);
  message.mutable_handles(0)->set_step(0.001);
  bundle.mutable_template_()->clear_parameters();
  ASSERT_EQ(FillAndCheck(bundle, Trial::kThorough), absl::OkStatus());
  ASSERT_EQ(bundle.template_().parameters_size(), 1);
  EXPECT_EQ(bundle.template_().parameters(0).name(), "height");
  EXPECT_DOUBLE_EQ(bundle.template_().parameters(0).minimum(), drawn - 0.01);
  EXPECT_DOUBLE_EQ(bundle.template_().parameters(0).step(), 0.001);
}

TEST(AssemblyTemplateChecks, EveryFaultOfHandlesAndConditionsIsTold) {
  v1::TemplateBundle bundle = Bookshelf();
  v1::Template& message = *bundle.mutable_template_();
  message.clear_parameters();
  v1::AssemblyTemplate& handled = *message.mutable_assembly();
  handled.mutable_handles(0)->mutable_measure()->set_element("chimney");
  handled.mutable_handles(1)->set_parameter("no name");
  handled.mutable_handles(1)->set_minimum(5);
  handled.mutable_handles(1)->set_maximum(4);
  v1::BoundaryCondition& condition = *message.add_boundary_conditions();
  condition.set_name("books");
  condition.set_kind(v1::BoundaryCondition::FORCE);
  condition.set_part("chimney");
  condition.set_face("z_max");
  condition.add_components("0");
  const absl::Status status = FillAndCheck(bundle, Trial::kDefaults);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  for (const char* field : {"assembly.handles[0].measure", "assembly.handles[1].parameter",
                            "assembly.handles[1].minimum", "boundary_conditions[0].part",
                            "boundary_conditions[0].components"}) {
    EXPECT_THAT(status.message(), HasSubstr(field));
  }
}

TEST(AssemblyTemplateChecks, WordsOfTheExpressionLanguageAreNoParameters) {
  v1::TemplateBundle bundle = Bookshelf();
  bundle.mutable_template_()->clear_parameters();
  bundle.mutable_template_()->mutable_assembly()->mutable_handles(0)->set_parameter("pi");
  const absl::Status status = FillAndCheck(bundle, Trial::kDefaults);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("assembly.handles[0].parameter"));
}

TEST(AssemblyTemplateChecks, SizesThatCannotBeHadTogetherAreNamed) {
  v1::TemplateBundle bundle = Bookshelf();
  v1::AssemblyTemplate& handled = *bundle.mutable_template_()->mutable_assembly();
  // What stands on the floor ends as high as it is tall.
  v1::AssemblyHandle twin = handled.handles(0);
  twin.mutable_measure()->set_kind(v1::Measure::MAXIMUM);
  twin.set_parameter("twin");
  *handled.add_handles() = twin;
  bundle.mutable_template_()->clear_parameters();
  ASSERT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  const auto compiled = Compile(bundle);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  Eigen::VectorXd q = parametric::Defaults((*compiled)->parameters());
  q(0) = (*compiled)->parameters()[0].minimum;
  const absl::Status status = (*compiled)->Evaluate(q).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "DEMANDS_CONFLICT");
  EXPECT_THAT(status.message(), HasSubstr(twin.measure().element()));
}

TEST(AssemblyTemplateChecks, WhatFailsAtTheDefaultsIsRefused) {
  v1::TemplateBundle bundle = Bookshelf();
  v1::Template& message = *bundle.mutable_template_();
  const v1::Parameter first = message.parameters(0);
  v1::BoundaryCondition& condition = *message.add_boundary_conditions();
  condition.set_name("wind");
  condition.set_kind(v1::BoundaryCondition::PRESSURE);
  condition.set_part(bundle.assembly().parts(0).name() + " 1");
  condition.set_face("x_min");
  condition.add_components("1 / (" + first.name() + " - " + std::to_string(first.default_value()) +
                           ")");
  const absl::Status status = FillAndCheck(bundle, Trial::kThorough);
  EXPECT_EQ(DetailOf(status).field, "boundary_conditions[0].components[0]") << status;
  EXPECT_THAT(status.message(), HasSubstr("at the defaults"));

  bundle = Bookshelf();
  *bundle.mutable_template_()->mutable_assembly()->add_handles() =
      bundle.template_().assembly().handles(0);
  bundle.mutable_template_()->clear_parameters();
  EXPECT_THAT(FillAndCheck(bundle, Trial::kThorough).message(), HasSubstr("is given twice"));
}

TEST(AssemblyTemplateChecks, ConditionsFollowTheParameters) {
  v1::TemplateBundle bundle = Bookshelf();
  v1::Template& message = *bundle.mutable_template_();
  const v1::AssemblyPart& part = bundle.assembly().parts(0);
  const std::string first = bundle.template_().parameters(0).name();
  v1::BoundaryCondition& condition = *message.add_boundary_conditions();
  condition.set_name("books");
  condition.set_kind(v1::BoundaryCondition::FORCE);
  condition.set_part(part.name() + " 1");
  condition.set_face("z_max");
  for (const std::string& component : {std::string("0"), std::string("0"), "-100 * " + first}) {
    condition.add_components(component);
  }
  ASSERT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  const auto compiled = Compile(bundle);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  const Eigen::VectorXd q = parametric::Defaults((*compiled)->parameters());
  const auto design = (*compiled)->Evaluate(q);
  ASSERT_TRUE(design.ok()) << design.status();
  ASSERT_EQ(design->boundary_conditions.size(), 1U);
  EXPECT_DOUBLE_EQ(design->boundary_conditions[0].force.z(), -100 * q(0));
}

}  // namespace
}  // namespace mortise::templates
