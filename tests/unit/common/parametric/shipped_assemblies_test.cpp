// The assemblies that ship: all can be read, made of items that ship, and what they are
// parametrised to keeps parts apart that do not touch, and parts together that do.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/base/files.h"
#include "common/parametric/assembly_codec.h"
#include "common/parametric/collection.h"
#include "common/parametric/contact_check.h"
#include "common/parametric/element.h"
#include "common/parametric/feasible_set.h"
#include "common/parametric/relationship.h"
#include "common/parametric/rest_pose.h"
#include "common/parametric/template_codec.h"
#include "tests/unit/common/parametric/assemblies.h"

namespace mortise::parametric {
namespace {

constexpr int kSamples = 1000;
constexpr double kAlignment = 1e-6;  // m, what counts as one plane

std::filesystem::path CollectionFolder() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "collection";
}

std::vector<std::string> Files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(CollectionFolder() / "assemblies")) {
    files.push_back(entry.path().stem().string());
  }
  return files;
}

const std::vector<Item>& ShippedItems() {
  static const auto* const items = [] {
    auto* const read = new std::vector<Item>();
    const Collection collection = ReadCollection(CollectionFolder()).value();
    for (const v1::Item& message : collection.items) {
      read->push_back(*FromProto(message));
    }
    return read;
  }();
  return *items;
}

class ShippedAssembly : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto path = CollectionFolder() / "assemblies" / (GetParam() + ".textproto");
    const auto text = ReadFile(path);
    ASSERT_TRUE(text.ok()) << text.status();
    const auto message = ParseAssemblyText(*text, path.filename().string());
    ASSERT_TRUE(message.ok()) << message.status();
    auto assembly = FromProto(*message, ShippedItems());
    ASSERT_TRUE(assembly.ok()) << assembly.status();
    assembly_ = *std::move(assembly);
    elements_ = MakeElements(assembly_, kAlignment);
    FollowPrincipalPatterns(elements_, TouchingPairs(elements_), kAlignment);
    drawn_ = DrawnParameters(assembly_, elements_);
  }

  FeasibleSet Parametrized() const {
    auto relationships =
        FindRelationships(assembly_, elements_, TouchingPairs(elements_), kAlignment);
    for (Relationship& held : Anchor(elements_, 0)) relationships.push_back(std::move(held));
    auto set = FeasibleSet::Create(std::move(relationships), drawn_,
                                   VariablesWithin(assembly_, elements_, 0));
    EXPECT_TRUE(set.ok()) << set.status();
    return *std::move(set);
  }

  Assembly assembly_;
  std::vector<Element> elements_;
  Eigen::VectorXd drawn_;
};

TEST_P(ShippedAssembly, MayBeChangedInSeveralWays) {
  EXPECT_GE(assembly_.parts.size(), 10U);
  EXPECT_LE(assembly_.parts.size(), 200U);
  EXPECT_GE(Parametrized().degrees_of_freedom(), 3);
}

// Part by part, in every rest pose.
TEST_P(ShippedAssembly, KeepsContactsSizesAndGaps) {
  const FeasibleSet set = Parametrized();
  const auto samples = set.Sample(kSamples, 1);
  ASSERT_TRUE(samples.ok()) << samples.status();
  const ContactCheck check(assembly_, elements_, kAlignment);
  for (const Eigen::VectorXd& q : *samples) {
    const auto faults = check.FaultsAt(q);
    ASSERT_TRUE(faults.ok()) << faults.status();
    ASSERT_TRUE(faults->empty()) << Describe(faults->front());
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedAssembly, ::testing::ValuesIn(Files()),
                         [](const auto& assembly) { return assembly.param; });

}  // namespace
}  // namespace mortise::parametric
