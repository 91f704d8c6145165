// The assemblies that ship: all can be read, made of items that ship, and what they are
// parametrised to keeps parts apart that do not touch, and parts together that do.
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/assembly/relations/feasible_set.h"

namespace mortise::parametric {
namespace {

constexpr int kSamples = 1000;

class ShippedAssembly : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto assembly = ReadShippedAssembly(GetParam());
    ASSERT_TRUE(assembly.ok()) << assembly.status();
    auto parametric = ParametricAssembly::Create(*std::move(assembly));
    ASSERT_TRUE(parametric.ok()) << parametric.status();
    parametric_ = *std::move(parametric);
  }

  std::optional<ParametricAssembly> parametric_;
};

TEST_P(ShippedAssembly, MayBeChangedInSeveralWays) {
  EXPECT_GE(parametric_->assembly().parts.size(), 10U);
  EXPECT_LE(parametric_->assembly().parts.size(), 200U);
  EXPECT_GE(parametric_->feasible_set().degrees_of_freedom(), 3);
  const auto sizes = parametric_->AdjustableSizes();
  ASSERT_TRUE(sizes.ok()) << sizes.status();
  EXPECT_GE(sizes->size(), 3U);
}

// Part by part, in every rest pose.
TEST_P(ShippedAssembly, KeepsContactsSizesAndGaps) {
  const auto samples = parametric_->Sample(kSamples, 1);
  ASSERT_TRUE(samples.ok()) << samples.status();
  for (const Eigen::VectorXd& q : *samples) {
    const auto faults = parametric_->FaultsAt(q);
    ASSERT_TRUE(faults.ok()) << faults.status();
    ASSERT_TRUE(faults->empty()) << Describe(faults->front());
  }
}

// A subtree is a template by itself, to be cut out and put into others: what binds it speaks of its
// own parameters only, and what it allows by itself keeps all of that.
TEST_P(ShippedAssembly, EachSubtreeIsSelfContained) {
  const Assembly& assembly = parametric_->assembly();
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.1);
  for (int group = 0; group < static_cast<int>(assembly.groups.size()); ++group) {
    SCOPED_TRACE(assembly.groups[static_cast<std::size_t>(group)].name);
    const std::vector<int> variables = VariablesWithin(assembly, parametric_->elements(), group);
    const std::set<int> own(variables.begin(), variables.end());
    const std::vector<Relationship> within =
        RelationshipsWithin(assembly, parametric_->relationships(), group);
    for (const Relationship& relationship : within) {
      for (const LinearTerm& term : relationship.form.terms) {
        EXPECT_TRUE(own.count(term.variable)) << relationship.description;
      }
    }
    const auto set = FeasibleSet::Create(within, parametric_->drawn(), variables);
    ASSERT_TRUE(set.ok()) << set.status();
    Eigen::VectorXd wish = parametric_->drawn();
    for (double& entry : wish) entry += normal(random);
    const auto nearest = set->Nearest(wish);
    ASSERT_TRUE(nearest.ok()) << nearest.status();
    EXPECT_TRUE(set->Violations(*nearest, 1e-7).empty());
    for (Eigen::Index i = 0; i < wish.size(); ++i) {
      if (own.count(static_cast<int>(i))) continue;
      EXPECT_EQ((*nearest)[i], parametric_->drawn()[i]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedAssembly, ::testing::ValuesIn(ShippedAssemblyIds()),
                         [](const auto& assembly) { return assembly.param; });

}  // namespace
}  // namespace mortise::parametric
