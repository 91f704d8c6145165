// Connections are compared by what they connect, and how that lies to each other.
#include "services/composer/connecting/connection_descriptor.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

const WantedMotion kFirm;

std::string SameItem(const std::string& item) { return item; }
std::string AnyItem(const std::string&) { return ""; }

PrincipalPart PartNamed(const Design& design, const std::string& name) {
  for (const PrincipalPart& part : PrincipalPartsOf(design)) {
    if (part.name == name) return part;
  }
  ADD_FAILURE() << "there is no part " << name;
  return {};
}

// The parts as drawn find the connection that they have.
TEST(ConnectionDescriptorTest, ADesignFindsItsOwnConnections) {
  const Design& design = ShippedDesign("bookshelf");
  const auto nearest =
      ConnectionIndex(AllShippedConnections(), SameItem)
          .Nearest(PartNamed(design, "side 2"), PartNamed(design, "shelf 4"), kFirm, 4, 5);
  ASSERT_EQ(nearest.size(), 5U);
  EXPECT_NEAR(nearest[0].distance, 0, 1e-9);
  EXPECT_EQ(nearest[0].connection->source, "assemblies/bookshelf");
  EXPECT_EQ(nearest[0].connection->connection.name, "'side 2' with 'shelf 4'");
  for (std::size_t i = 1; i < nearest.size(); ++i) {
    EXPECT_GE(nearest[i].distance, nearest[i - 1].distance);
    EXPECT_FALSE(nearest[i].connection->connection.connecting.empty());
  }
}

TEST(ConnectionDescriptorTest, ItDoesNotMatterWhichIsTheFirst) {
  const Design& design = ShippedDesign("bookshelf");
  const auto nearest =
      ConnectionIndex(AllShippedConnections(), SameItem)
          .Nearest(PartNamed(design, "shelf 4"), PartNamed(design, "side 2"), kFirm, 4, 1);
  ASSERT_EQ(nearest.size(), 1U);
  EXPECT_EQ(nearest[0].first, 1);
  EXPECT_EQ(nearest[0].second, 0);
  EXPECT_NEAR(nearest[0].distance, 0, 1e-9);
}

TEST(ConnectionDescriptorTest, MaterialsMustMatch) {
  const Design& design = ShippedDesign("bookshelf");
  PrincipalPart side = PartNamed(design, "side 2");
  side.item = "items/of-nothing-there-is";
  const PrincipalPart shelf = PartNamed(design, "shelf 4");
  EXPECT_TRUE(
      ConnectionIndex(AllShippedConnections(), SameItem).Nearest(side, shelf, kFirm, 4, 5).empty());
  EXPECT_FALSE(
      ConnectionIndex(AllShippedConnections(), AnyItem).Nearest(side, shelf, kFirm, 4, 5).empty());
}

// The slides of the drawers lie against their fronts, too.
TEST(ConnectionDescriptorTest, ADrawerFindsSlidesAndNothingElse) {
  const Design& design = ShippedDesign("tool_cart");
  const auto nearest =
      ConnectionIndex(AllShippedConnections(), AnyItem)
          .Nearest(PartNamed(design, "upright 1.1"), PartNamed(design, "drawer side 1"),
                   {true, parametric::JointKind::kPrismatic}, 4, 5);
  ASSERT_FALSE(nearest.empty());
  EXPECT_NEAR(nearest[0].distance, 0, 1e-9);
  for (const RankedConnection& one : nearest) {
    ASSERT_FALSE(one.connection->connection.assembly.joints.empty());
    EXPECT_EQ(one.connection->connection.assembly.joints[0].kind,
              parametric::JointKind::kPrismatic);
  }
}

TEST(ConnectionDescriptorTest, FixedSizesCountMore) {
  const Design& design = ShippedDesign("bookshelf");
  const PrincipalPart side = PartNamed(design, "side 2"), shelf = PartNamed(design, "shelf 4");
  const PairDescriptor there = DescriptorOf(side, shelf);
  PairDescriptor longer = there, thicker = there;
  longer.sizes[1].x() += 0.01;
  thicker.sizes[1].z() += 0.01;
  EXPECT_NEAR(DistanceOf(there, longer, 4), 0.01, 1e-12);
  EXPECT_NEAR(DistanceOf(there, thicker, 4), 0.04, 1e-12);
  EXPECT_EQ(DistanceOf(there, there, 4), 0);
}

// What lies before something is told from what lies behind it.
TEST(ConnectionDescriptorTest, TheOrderOfPartsCounts) {
  const Design& design = ShippedDesign("bookshelf");
  const PrincipalPart shelf = PartNamed(design, "shelf 4");
  const PairDescriptor left = DescriptorOf(PartNamed(design, "side 1"), shelf);
  const PairDescriptor right = DescriptorOf(PartNamed(design, "side 2"), shelf);
  EXPECT_GT(DistanceOf(left, right, 4), 1);
}

}  // namespace
}  // namespace mortise::composer
