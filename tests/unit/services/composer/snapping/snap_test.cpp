// Components of designs that ship, dropped into others.
#include "services/composer/snapping/snap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "services/composer/model/placed_forms.h"
#include "services/composer/snapping/plane.h"
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

// Nothing of the body lies beside it over its height as the cheeks do beside the first drawer: it
// is not stretched from the shelf to the first.
TEST(SnapTest, ASecondDrawerKeepsItsHeight) {
  const Design& body = ShippedDesign("tool_cart");
  const Design drawn = ShippedComponent("tool_cart", "drawer");
  for (const Eigen::Vector3d& off : {Eigen::Vector3d(0, 0.016, -0.156), {0.02, 0, -0.178}}) {
    Design dropped = drawn;
    dropped.shift = off;
    ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &body, body));
    ExpectFeasible(snapped.component);
    Eigen::Vector3d moved = BoundsOf(snapped.component).minimum - BoundsOf(drawn).minimum;
    for (const PrincipalPart& part : PrincipalPartsOf(drawn)) {
      SCOPED_TRACE(part.name);
      const BoundingBox there = BoxIn(snapped.component, part.name);
      ExpectSame(there, {part.box.minimum + moved, part.box.maximum + moved}, 1e-7);
    }
    // Below the first, on slides of its own.
    EXPECT_NEAR(moved.x(), 0, 1e-7);
    EXPECT_NEAR(moved.y(), 0, 1e-7);
    EXPECT_LE(std::abs(moved.z() - off.z()), SnapOptions().threshold);
    EXPECT_GE(BoxIn(snapped.component, "drawer bottom").minimum.z(),
              BoxIn(body, "shelf").maximum.z());
    EXPECT_LE(BoxIn(snapped.component, "drawer front").maximum.z(),
              BoxIn(body, "drawer front").minimum.z() + 1e-7);
  }
}

// The upper edge of the plinth lay against a shelf. The lower ends of the sides are in one plane
// with it here, but between them there is none.
TEST(SnapTest, APlinthIsNotLaidAgainstWhatIsBesideIt) {
  const Design& body = ShippedDesign("bookshelf");
  Design dropped = ShippedComponent("bookshelf", "plinth");
  dropped.shift = {0.01, 0.023, -0.1};
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &body, body));
  const BoundingBox plinth = BoxIn(snapped.component, "plinth");
  EXPECT_NEAR(plinth.minimum.x(), BoxIn(body, "side 1").maximum.x(), 1e-8);
  EXPECT_NEAR(plinth.maximum.x(), BoxIn(body, "side 2").minimum.x(), 1e-8);
  for (const Alignment& alignment : snapped.alignments) {
    EXPECT_FALSE(alignment.component_plane == "z maximum" && alignment.body_element == "side 1")
        << alignment.text;
  }
  EXPECT_LE(plinth.minimum.z(), 1e-8);
  EXPECT_NEAR(plinth.size().z(), 0.08, 1e-8);
}

// A copy of a part of a design dropped anywhere onto it: faces that are laid against faces of
// the body have them across, and nothing runs into anything deeper than where it was dropped.
TEST(SnapTest, WhatIsLaidAgainstAFaceLiesAcrossFromIt) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> off(-0.03, 0.03);
  int contacts = 0;
  for (const auto& [id, node] :
       std::vector<std::pair<std::string, std::string>>{{"bookshelf", "shelf 3"},
                                                        {"cabinet", "left drawer"},
                                                        {"tool_cart", "rail 1"},
                                                        {"dining_table", "long apron 1"},
                                                        {"slatted_armchair", "left side"},
                                                        {"garden_cart", "box"}}) {
    SCOPED_TRACE(node);
    const Design& body = ShippedDesign(id);
    const std::vector<PrincipalPart> body_parts = PrincipalPartsOf(body);
    const Design component = ShippedComponent(id, node);
    for (int drop = 0; drop < 6; ++drop) {
      const PrincipalPart& onto = body_parts[random() % body_parts.size()];
      const Design dropped = DroppedAt(
          component, onto.box.center() + Eigen::Vector3d(off(random), off(random), off(random)));
      ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &body, body));
      ExpectFeasible(snapped.component);
      for (const Alignment& made : snapped.alignments) {
        const bool faces = made.component_plane.find("m") != std::string::npos &&
                           made.component_plane.size() == made.body_plane.size() &&
                           made.component_plane != made.body_plane;
        if (!made.from_original || !faces) continue;
        const BoundingBox own = BoxIn(snapped.component, made.component_element);
        const BoundingBox other = BoxIn(body, made.body_element);
        Eigen::Vector3d shared =
            own.maximum.cwiseMin(other.maximum) - own.minimum.cwiseMax(other.minimum);
        shared[static_cast<int>(made.axis)] = 1;
        EXPECT_GT(shared.minCoeff(), 0) << made.text;
        ++contacts;
      }
    }
  }
  EXPECT_GT(contacts, 20);
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

// The legs of the table stand out beyond its aprons; those of the workbench do not, so that its top
// ends level with both. Here it ends with the legs: nothing that it lies on sticks out.
TEST(SnapTest, ATopThatCoveredItsLegsCoversThese) {
  const Design body = ShippedComponent("dining_table", "frame");
  const Design dropped = DroppedAt(ShippedComponent("workbench", "top"), {0.8, 0.45, 0.75});
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &ShippedDesign("workbench"), body));
  ExpectFeasible(snapped.component);
  const BoundingBox top = BoxIn(snapped.component, "top board");
  for (const PrincipalPart& part : PrincipalPartsOf(body)) {
    EXPECT_LE(top.minimum.x(), part.box.minimum.x() + 1e-8) << part.name;
    EXPECT_LE(top.minimum.y(), part.box.minimum.y() + 1e-8) << part.name;
    EXPECT_GE(top.maximum.x(), part.box.maximum.x() - 1e-8) << part.name;
    EXPECT_GE(top.maximum.y(), part.box.maximum.y() - 1e-8) << part.name;
  }
  EXPECT_NEAR(top.size().y(), BoundsOf(body).size().y(), 1e-8);
}

// A door with its hinges, on a case that is wider than its own and has no door yet.
TEST(SnapTest, ADoorMeetsTheMiddleOfAWiderCabinet) {
  Design body = ShippedComponent("cabinet", "case");
  ASSERT_OK_AND_ASSIGN(const parametric::Adjustment wider,
                       body.assembly->Adjust(body.q, {{{"top", Axis::kX}, 1.12}},
                                             parametric::DemandPolicy::kStrict));
  body.q = wider.q;
  const Design drawn = ShippedComponent("cabinet", "left door");
  Design dropped = drawn;
  dropped.shift = BoxIn(body, "side 1").minimum + Eigen::Vector3d(0.011, 0.004, 0.007);
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &ShippedDesign("cabinet"), body));
  ExpectFeasible(snapped.component);
  const BoundingBox door = BoxIn(snapped.component, "left door");
  EXPECT_NEAR(door.minimum.x(), BoxIn(body, "side 1").minimum.x(), 1e-7);
  // As far as the top says that doors on the left reach: to the middle, but for a gap.
  const std::vector<DesignPlane> planes = PlanesOf(body, PrincipalPartsOf(body));
  const auto middle = std::find_if(planes.begin(), planes.end(), [](const DesignPlane& plane) {
    return plane.name == "left fronts";
  });
  ASSERT_NE(middle, planes.end());
  EXPECT_NEAR(door.maximum.x(), middle->now, 1e-7);
  EXPECT_NEAR(door.size().x(), 1.12 / 2, 0.002);
  EXPECT_NEAR(door.size().z(), BoxIn(drawn, "left door").size().z(), 1e-7);
}

// A case with a door that is drawn open, and rests shut over both sides (thesis Figure 5-5).
parametric::Assembly CaseWithOpenDoor() {
  parametric::Assembly drawn;
  drawn.name = "assemblies/case-with-door";
  drawn.groups = {{"assemblies/case-with-door", -1}, {"case", 0}, {"door", 0}};
  const auto add = [&](const std::string& name, int group, const Eigen::Vector3d& minimum,
                       const Eigen::Vector3d& maximum, bool connecting = false) {
    parametric::AssemblyPart& part = drawn.parts.emplace_back();
    part.name = name;
    part.group = group;
    part.connecting = connecting;
    part.box = {minimum, maximum};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double size = part.box.size()[static_cast<Eigen::Index>(axis)];
      const bool is_fixed = connecting || size == 0.02;
      part.limits[axis] = {is_fixed ? size : size / 2, is_fixed ? size : 2 * size};
    }
  };
  add("left side", 1, {0, 0, 0}, {0.02, 0.4, 0.8});
  add("right side", 1, {0.58, 0, 0}, {0.6, 0.4, 0.8});
  add("bottom", 1, {0.02, 0, 0}, {0.58, 0.4, 0.02});
  add("top", 1, {0.02, 0, 0.78}, {0.58, 0.4, 0.8});
  // Shut, it covers x from 0 to 0.6 and y from -0.02 to 0.
  add("door", 2, {-0.02, -0.6, 0}, {0, 0, 0.8});
  add("hinge", 1, {-0.01, -0.04, 0.35}, {0.01, 0.04, 0.45}, true);
  parametric::Joint& hinge = drawn.joints.emplace_back();
  hinge.name = "hinge";
  hinge.group = 2;
  hinge.center = {0, 0, 0.4};
  hinge.lower = 0;
  hinge.upper = 3;
  hinge.rest_poses = {{"shut", {0, 0, std::acos(0.0)}}};
  return drawn;
}

TEST(SnapTest, ADoorThatIsOpenAlignsWithTheOppositeSideWhenItIsShut) {
  ASSERT_OK_AND_ASSIGN(const Design original, AsDrawn(CaseWithOpenDoor()));
  const parametric::Assembly& whole = original.assembly->assembly();
  ASSERT_OK_AND_ASSIGN(parametric::Assembly part, parametric::SubTreeOf(whole, "door"));
  ASSERT_OK_AND_ASSIGN(Design door, AsDrawn(std::move(part)));
  ASSERT_OK_AND_ASSIGN(part, parametric::SubTreeOf(whole, "case"));
  ASSERT_OK_AND_ASSIGN(Design body, AsDrawn(std::move(part)));
  for (const double width : {0.6, 0.5, 0.85}) {
    SCOPED_TRACE(width);
    ASSERT_OK_AND_ASSIGN(const parametric::Adjustment adjusted,
                         body.assembly->Adjust(body.q, {{{"top", Axis::kX}, width - 0.04}},
                                               parametric::DemandPolicy::kStrict));
    body.q = adjusted.q;
    const BoundingBox left = BoxIn(body, "left side"), right = BoxIn(body, "right side");
    door.shift = left.minimum + Eigen::Vector3d(0.008, -0.006, 0.004);
    ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(door, &original, body));
    ExpectFeasible(snapped.component);
    const BoundingBox open = BoxIn(snapped.component, "door");
    // Hung where it was hung, and as wide as the case when it is turned by a quarter.
    EXPECT_NEAR(open.maximum.x(), left.minimum.x(), 1e-7);
    EXPECT_NEAR(open.maximum.y(), left.minimum.y(), 1e-7);
    EXPECT_NEAR(open.size().y(), right.maximum.x() - left.minimum.x(), 1e-7);
    EXPECT_NEAR(open.size().x(), 0.02, 1e-9);
    EXPECT_NEAR(open.minimum.z(), left.minimum.z(), 1e-7);
    EXPECT_NEAR(open.maximum.z(), left.maximum.z(), 1e-7);
    const auto shut = std::find_if(
        snapped.alignments.begin(), snapped.alignments.end(), [](const Alignment& alignment) {
          return alignment.component_plane == "x maximum in 'hinge: shut'";
        });
    ASSERT_NE(shut, snapped.alignments.end());
    EXPECT_EQ(shut->body_element, "right side");
  }
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
