// Boats, carts, chairs, lamps, planes and tables that ship as families: nearly everywhere in the
// box of its parameters each is a design that holds together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/assembly/parametric_assembly.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

constexpr int kDesigns = 40;

// With the assembly that it exposes, if it does.
v1::TemplateBundle Family(const std::string& id) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/" + id);
  const std::string& assembly = bundle.template_().assembly().assembly();
  if (!assembly.empty()) {
    *bundle.mutable_assembly() = ShippedAssembly(assembly).assembly();
  }
  return bundle;
}

Eigen::VectorXd RandomParameters(const Template& family, std::mt19937_64& random) {
  Eigen::VectorXd q = parametric::Defaults(family.parameters());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const parametric::Parameter& range = family.parameters()[static_cast<std::size_t>(i)];
    const double share = static_cast<double>(random() >> 11) * 0x1p-53;
    q[i] = range.minimum + share * (range.maximum - range.minimum);
  }
  return q;
}

class ShippedFamilyTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    bundle_ = Family(GetParam());
    ASSERT_EQ(FillAndCheck(bundle_, Trial::kDefaults), absl::OkStatus());
    auto compiled = Compile(bundle_);
    ASSERT_TRUE(compiled.ok()) << compiled.status();
    family_ = *std::move(compiled);
  }

  v1::TemplateBundle bundle_;
  std::shared_ptr<const Template> family_;
};

// Of parts, Complete has looked at many designs for parts in each other and pegs that stick out.
TEST_P(ShippedFamilyTest, HoldsTogetherAtRandomParameters) {
  std::mt19937_64 random(3);
  int made = 0;
  for (int i = 0; i < kDesigns; ++i) {
    const Eigen::VectorXd q = RandomParameters(*family_, random);
    const auto design = family_->Evaluate(q);
    if (!design.ok()) continue;
    ++made;
    EXPECT_GT(design->mass, 0);
    const auto assembly = family_->AssemblyAt(q);
    ASSERT_TRUE(assembly.ok()) << assembly.status();
    if (!assembly->has_value()) continue;
    const auto faults = (*assembly)->assembly->FaultsAt((*assembly)->q);
    ASSERT_TRUE(faults.ok()) << faults.status();
    EXPECT_TRUE(faults->empty()) << parametric::Describe(faults->front());
  }
  EXPECT_GE(made, 0.9 * kDesigns);
}

TEST_P(ShippedFamilyTest, ExposesAFewParametersThatPeopleCanRead) {
  EXPECT_GE(family_->parameters().size(), 2u);
  EXPECT_LE(family_->parameters().size(), 9u);
  std::set<std::string> titles;
  for (const parametric::Parameter& parameter : family_->parameters()) {
    EXPECT_FALSE(parameter.title.empty()) << parameter.name;
    EXPECT_TRUE(titles.insert(parameter.title).second) << parameter.title;
    EXPECT_GT(parameter.step, 0) << parameter.name;
    EXPECT_GE(parameter.maximum, 1.1 * parameter.minimum) << parameter.name;
  }
  EXPECT_FALSE(bundle_.template_().description().empty());
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedFamilyTest,
                         ::testing::Values("bar-chair", "crossed-side-table", "fin-lamp",
                                           "garden-cart", "hand-truck", "ladder-back-chair",
                                           "pendant-lamp", "punt", "rocking-chair",
                                           "serving-trolley", "shade-lamp", "slat-lantern",
                                           "slatted-armchair", "slatted-coffee-table",
                                           "toy-biplane", "toy-catamaran", "toy-glider",
                                           "toy-seaplane", "toy-tug", "trestle-desk"),
                         [](const auto& family) {
                           std::string name = family.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace mortise::templates
