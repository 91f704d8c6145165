// Components of designs that ship, dropped into others.
#include "services/composer/snapping/snap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/errors.h"
#include "services/composer/model/placed_forms.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;

BoundingBox BoxIn(const Design& design, const std::string& part) {
  for (const parametric::PlacedPart& placed : PartsOf(design)) {
    if (placed.name == part) return placed.box;
  }
  ADD_FAILURE() << "there is no part " << part;
  return {};
}

void ExpectSame(const BoundingBox& a, const BoundingBox& b, double within) {
  EXPECT_LE((a.minimum - b.minimum).cwiseAbs().maxCoeff(), within);
  EXPECT_LE((a.maximum - b.maximum).cwiseAbs().maxCoeff(), within);
}

void ExpectFeasible(const Design& design) {
  EXPECT_TRUE(design.assembly->feasible_set().Violations(design.q, 1e-8).empty());
}

TEST(SnapTest, AShelfFillsTheCaseOfAnotherCabinet) {
  const Design body = ShippedComponent("cabinet", "case");
  const Design dropped = DroppedAt(ShippedComponent("bookshelf", "shelf 3"), {0.49, 0.22, 0.2});
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &ShippedDesign("bookshelf"), body));
  ExpectFeasible(snapped.component);
  const BoundingBox shelf = BoxIn(snapped.component, "shelf 3");
  EXPECT_NEAR(shelf.minimum.x(), 0.018, 1e-8);
  EXPECT_NEAR(shelf.maximum.x(), 0.982, 1e-8);
  EXPECT_NEAR(shelf.maximum.y(), 0.45, 1e-8);
  EXPECT_NEAR(shelf.size().z(), 0.018, 1e-9);
  EXPECT_NEAR(shelf.center().z(), 0.2, 1e-8);  // nothing says how high
  EXPECT_GE(snapped.alignments.size(), 3U);
  for (const Alignment& alignment : snapped.alignments) EXPECT_FALSE(alignment.text.empty());
}

TEST(SnapTest, ADrawerKeepsTheRoomOfItsSlides) {
  const Design body = ShippedComponent("tool_cart", "frame");
  const Design drawn = ShippedComponent("tool_cart", "drawer");
  Design dropped = drawn;
  dropped.shift = {0.012, 0.02, -0.009};
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &ShippedDesign("tool_cart"), body));
  // All of it is where it was drawn: it is moved as a whole.
  for (const PrincipalPart& part : PrincipalPartsOf(drawn)) {
    SCOPED_TRACE(part.name);
    ExpectSame(BoxIn(snapped.component, part.name), part.box, 1e-7);
  }
}

TEST(SnapTest, ADoorIsLevelWithItsSideAndMeetsTheMiddle) {
  const Design body = ShippedComponent("cabinet", "case");
  const Design drawn = ShippedComponent("cabinet", "left door");
  Design dropped = drawn;
  dropped.shift = {0.011, 0.004, 0.007};
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &ShippedDesign("cabinet"), body));
  ExpectSame(BoxIn(snapped.component, "left door"), BoxIn(drawn, "left door"), 1e-7);
}

TEST(SnapTest, ATopThatIsLoweredKeepsItsThickness) {
  const Design body = ShippedComponent("workbench", "frame");
  const Design dropped = DroppedAt(ShippedComponent("dining_table", "top"), {0.8, 0.36, 0.85});
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &ShippedDesign("dining_table"), body));
  const BoundingBox top = BoxIn(snapped.component, "top board");
  EXPECT_NEAR(top.minimum.z(), 0.815, 1e-8);
  EXPECT_NEAR(top.size().z(), 0.028, 1e-12);
}

// What is in its place stays there.
TEST(SnapTest, SnappingTwiceIsSnappingOnce) {
  const Design body = ShippedComponent("cabinet", "case");
  const Design dropped = DroppedAt(ShippedComponent("bookshelf", "shelf 3"), {0.5, 0.2, 0.21});
  ASSERT_OK_AND_ASSIGN(const Snapped once, Snap(dropped, &ShippedDesign("bookshelf"), body));
  ASSERT_OK_AND_ASSIGN(const Snapped twice,
                       Snap(once.component, &ShippedDesign("bookshelf"), body));
  EXPECT_LE((InSpace(once.component) - InSpace(twice.component)).cwiseAbs().maxCoeff(), 1e-8);
}

// Without an original, what is near is aligned: two chests side by side.
TEST(SnapTest, WholeDesignsAlignWithWhatIsNear) {
  const Design& body = ShippedDesign("toy_chest");
  Design dropped = body;
  dropped.shift = {0.911, 0.004, 0};
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, nullptr, body));
  const BoundingBox there = BoundsOf(snapped.component);
  EXPECT_NEAR(there.minimum.x(), BoundsOf(body).maximum.x(), 1e-8);
  EXPECT_NEAR(there.minimum.z(), 0, 1e-8);
  EXPECT_NEAR(BoxIn(snapped.component, "front").minimum.y(), BoxIn(body, "front").minimum.y(),
              1e-8);
}

TEST(SnapTest, BeyondTheThresholdNothingIsAligned) {
  const Design& body = ShippedDesign("toy_chest");
  Design dropped = body;
  dropped.shift = {1.5, 0.2, 0.7};
  SnapOptions options;
  options.threshold = 0.001;
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, nullptr, body, options));
  EXPECT_THAT(snapped.alignments, ::testing::IsEmpty());
  EXPECT_LE((InSpace(snapped.component) - InSpace(dropped)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(SnapTest, WhatIsFarFromEverythingIsRefused) {
  const Design& body = ShippedDesign("toy_chest");
  Design dropped = body;
  dropped.shift = {50, 0, 0};
  const absl::Status refused = Snap(dropped, nullptr, body).status();
  EXPECT_EQ(DetailOf(refused).reason, "SNAP_FAR");
}

}  // namespace
}  // namespace mortise::composer
