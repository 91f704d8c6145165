// Where parts lie as functions of q: they say so for other designs, too, as long as rows have as
// many parts.
#include "services/composer/model/placed_forms.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {
namespace {

class PlacedFormsTest : public ::testing::TestWithParam<std::string> {};

TEST_P(PlacedFormsTest, TheySayWhereThePartsOfOtherDesignsAre) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly(GetParam()));
  ASSERT_OK_AND_ASSIGN(const Design drawn, AsDrawn(std::move(assembly)));
  const std::vector<PrincipalPart> before = PrincipalPartsOf(drawn);
  ASSERT_OK_AND_ASSIGN(const auto samples, drawn.assembly->Sample(1, 7));
  // A small way towards another design, which leaves rows their numbers.
  Design other = drawn;
  other.q = drawn.q + 1e-3 * (samples.front() - drawn.q);
  other.shift = {1, 2, 3};
  const std::vector<PrincipalPart> after = PrincipalPartsOf(other);
  ASSERT_EQ(before.size(), after.size());
  const Eigen::VectorXd in_space = InSpace(other);
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (const Axis axis : parametric::kAxes) {
      const auto a = static_cast<std::size_t>(axis);
      const int at = static_cast<int>(axis);
      EXPECT_NEAR(before[i].center[a].At(in_space), after[i].box.center()[at], 1e-8);
      EXPECT_NEAR(before[i].size[a].At(in_space), after[i].box.size()[at], 1e-8);
      EXPECT_NEAR(FaceOf(before[i], axis, true).At(in_space), after[i].box.maximum[at], 1e-8);
      EXPECT_NEAR(FaceOf(before[i], axis, false).At(in_space), after[i].box.minimum[at], 1e-8);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, PlacedFormsTest,
                         ::testing::ValuesIn(parametric::ShippedAssemblyIds()),
                         [](const auto& shipped) { return shipped.param; });

TEST(PlacedFormsTest, ConnectingPartsAreLeftOut) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly("bookshelf"));
  ASSERT_OK_AND_ASSIGN(const Design drawn, AsDrawn(std::move(assembly)));
  const std::vector<PrincipalPart> parts = PrincipalPartsOf(drawn);
  EXPECT_EQ(parts.size(), 10U);
  for (const PrincipalPart& part : parts) {
    EXPECT_FALSE(part.name.starts_with("screw")) << part.name;
    EXPECT_EQ(part.drawn_as, part.name);
    EXPECT_FALSE(part.is_fixed[0] && part.is_fixed[1] && part.is_fixed[2]) << part.name;
  }
}

}  // namespace
}  // namespace mortise::composer
