// The assemblies that ship: all can be read, made of items that ship, and what they are
// parametrised to keeps parts apart that do not touch, and parts together that do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/base/files.h"
#include "common/parametric/assembly_codec.h"
#include "common/parametric/collection.h"
#include "common/parametric/element.h"
#include "common/parametric/feasible_set.h"
#include "common/parametric/relationship.h"
#include "common/parametric/rest_pose.h"
#include "common/parametric/template_codec.h"
#include "tests/unit/common/parametric/assemblies.h"

namespace mortise::parametric {
namespace {

constexpr int kSamples = 1000;
constexpr double kAlignment = 1e-6;    // m, what counts as one plane
constexpr double kPenetration = 1e-4;  // m, what a workshop does not see
constexpr double kGap = 1e-8;          // m, rounding

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

// How deep two elements' boxes intersect at q, m; negative: how far they are apart.
double Overlap(const Eigen::VectorXd& q, int a, int b) {
  double overlap = std::numeric_limits<double>::infinity();
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    const auto end = [&](int element, double side) {
      return q[CenterVariable(element, axis)] + side / 2 * q[SizeVariable(element, axis)];
    };
    overlap = std::min(overlap, std::min(end(a, 1), end(b, 1)) - std::max(end(a, -1), end(b, -1)));
  }
  return overlap;
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

TEST_P(ShippedAssembly, KeepsContactsAndMakesNoNewOnes) {
  const FeasibleSet set = Parametrized();
  const auto samples = set.Sample(kSamples, 1);
  ASSERT_TRUE(samples.ok()) << samples.status();
  const int count = static_cast<int>(elements_.size());
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < a; ++b) {
      const bool touch = Overlap(drawn_, a, b) >= -kGap;
      for (const Eigen::VectorXd& q : *samples) {
        const double overlap = Overlap(q, a, b);
        const bool kept = touch ? overlap >= -kGap : overlap < kPenetration;
        ASSERT_TRUE(kept) << elements_[static_cast<std::size_t>(a)].name << " and "
                          << elements_[static_cast<std::size_t>(b)].name << ": " << overlap
                          << " m, drawn " << Overlap(drawn_, a, b);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedAssembly, ::testing::ValuesIn(Files()),
                         [](const auto& assembly) { return assembly.param; });

}  // namespace
}  // namespace mortise::parametric
