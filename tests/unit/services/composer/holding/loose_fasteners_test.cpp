// Fasteners that join nothing.
#include "services/composer/holding/loose_fasteners.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/services/composer/holding/holding_parts.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::AssemblyPart;
using parametric::FixedPart;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

AssemblyPart Fastener(const std::string& name, const std::string& item, double from, double to) {
  AssemblyPart part = FixedPart(name, {0.1, 0.1, from}, {0.104, 0.104, to});
  part.item = item;
  part.connecting = true;
  part.item_axes = {Axis::kZ, Axis::kX, Axis::kY};
  return part;
}

// Two boards on each other, and a fastener from one height to another.
std::vector<Finding> Judge(const std::string& item, double from, double to) {
  return FindLooseFasteners(
      parametric::Named("boards", {FixedPart("lower", {0, 0, 0}, {0.5, 0.2, 0.02}),
                                   FixedPart("upper", {0, 0, 0.02}, {0.5, 0.2, 0.04}),
                                   Fastener("it", item, from, to)}),
      TestItems(), TestMaterials());
}

TEST(LooseFastenersTest, AScrewGoesIntoBothParts) {
  EXPECT_THAT(Judge("items/fastener-screw", 0.005, 0.04), IsEmpty());
  const auto alone = Judge("items/fastener-screw", 0.02, 0.04);
  ASSERT_THAT(alone, SizeIs(1));
  EXPECT_EQ(alone[0].rule, kJoinsNothing);
  EXPECT_EQ(alone[0].severity, Severity::kWarning);
  EXPECT_THAT(alone[0].parts, ElementsAre("it"));
  EXPECT_THAT(alone[0].text, HasSubstr("'upper' alone"));
}

TEST(LooseFastenersTest, AndNotIntoTheAir) {
  const auto found = Judge("items/fastener-screw", 0.1, 0.14);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].text, HasSubstr("no part"));
}

TEST(LooseFastenersTest, APegMayCarryWhatLiesOnIt) {
  EXPECT_THAT(Judge("items/fastener-dowel", 0.02, 0.04), IsEmpty());
  EXPECT_THAT(Judge("items/fastener-dowel", 0.025, 0.04), SizeIs(1));
}

TEST(LooseFastenersTest, HardwareCounts) {
  EXPECT_THAT(
      FindLooseFasteners(
          parametric::Named("board", {FixedPart("board", {0, 0, 0}, {0.5, 0.2, 0.02}),
                                      Fastener("screw", "items/fastener-screw", 0.005, 0.022),
                                      Fastener("plate", "items/fastener-bracket", 0.02, 0.022)}),
          TestItems(), TestMaterials()),
      IsEmpty());
}

TEST(LooseFastenersTest, DesignsThatShipHaveNone) {
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    SCOPED_TRACE(id);
    for (const Finding& finding :
         FindLooseFasteners(ShippedDesign(id).assembly->assembly(), parametric::ShippedItems(),
                            ShippedMaterials())) {
      ADD_FAILURE() << finding.parts.front() << " " << finding.text;
    }
  }
}

}  // namespace
}  // namespace mortise::composer
