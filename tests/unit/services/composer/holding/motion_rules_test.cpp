// What keeps parts from moving that are to move.
#include "services/composer/holding/motion_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/holding/holding_parts.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::FixedPart;
using parametric::JointKind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

// A flap that lies on a box, in a group of this name.
Assembly Box(const std::string& group, bool has_joint, JointKind kind = JointKind::kHinge) {
  Assembly box = parametric::Named("box", {FixedPart("box", {0, 0, 0}, {0.5, 0.5, 0.5}),
                                           FixedPart("board", {0, 0, 0.5}, {0.5, 0.5, 0.52})});
  box.groups.push_back({group, 0});
  box.parts[1].group = 1;
  if (!has_joint) return box;
  parametric::Joint& joint = box.joints.emplace_back();
  joint.name = "joint";
  joint.kind = kind;
  joint.group = 1;
  joint.center = {0.25, 0.5, 0.5};
  joint.axis = {0, 0, 1};
  return box;
}

// What holds the two, with these fasteners.
Joint Held(std::vector<Fastener> fasteners) {
  Joint joint;
  joint.principals = {Joined("box", {0, 0, 0}, {0.5, 0.5, 0.5}),
                      Joined("board", {0, 0, 0.5}, {0.5, 0.5, 0.52})};
  joint.fasteners = std::move(fasteners);
  return joint;
}

Fastener Upright(const std::string& name, FastenerKind kind, double x, double y) {
  return Pin(name, kind, 0.004, x, y, 0.48, 0.52);
}

TEST(MotionRulesTest, AScrewThroughAHingedBoardIsAFault) {
  const auto found = JudgeMotion(Box("anything", true),
                                 {Held({Upright("screw 1", FastenerKind::kScrew, 0.1, 0.1),
                                        Upright("screw 2", FastenerKind::kScrew, 0.4, 0.1)})});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, kScrewedFast);
  EXPECT_EQ(found[0].severity, Severity::kFault);
  EXPECT_THAT(found[0].parts, ElementsAre("board"));
  EXPECT_EQ(found[0].text,
            "'board' is to turn by 'joint', but 'screw 1', 'screw 2' hold it fast to 'box'");
}

// An axle, and what a slide runs along.
TEST(MotionRulesTest, WhatItMovesOnDoesNotHoldIt) {
  EXPECT_THAT(
      JudgeMotion(Box("anything", true), {Held({Upright("axle", FastenerKind::kBolt, 0.25, 0.5)})}),
      IsEmpty());
  EXPECT_THAT(JudgeMotion(Box("anything", true, JointKind::kPrismatic),
                          {Held({Upright("rod", FastenerKind::kBolt, 0.1, 0.1)})}),
              IsEmpty());
  EXPECT_THAT(JudgeMotion(Box("anything", true, JointKind::kPrismatic),
                          {Held({Upright("screw", FastenerKind::kScrew, 0.1, 0.1)})}),
              SizeIs(1));
  EXPECT_THAT(JudgeMotion(Box("anything", true, JointKind::kBall),
                          {Held({Upright("pin", FastenerKind::kBolt, 0.25, 0.5)})}),
              IsEmpty());
}

TEST(MotionRulesTest, ABracketThatIsFastenedToBothHoldsThem) {
  const Fastener bracket = Bracket("bracket", {0.1, -0.002, 0.45}, {0.14, 0, 0.52});
  Fastener below = Pin("screw below", FastenerKind::kScrew, 0.004, 0.12, 0.01, 0.46, 0.464);
  below.axis = 1;
  below.box = {{0.118, -0.002, 0.458}, {0.122, 0.02, 0.462}};
  Fastener above = below;
  above.name = "screw above";
  above.box = {{0.118, -0.002, 0.508}, {0.122, 0.02, 0.512}};
  EXPECT_THAT(JudgeMotion(Box("anything", true), {Held({bracket, below})}), IsEmpty());
  EXPECT_THAT(JudgeMotion(Box("anything", true), {Held({bracket, below, above})}), SizeIs(1));
}

TEST(MotionRulesTest, WhatIsCalledALidIsToMove) {
  const std::vector<Joint> screwed{Held({Upright("screw", FastenerKind::kScrew, 0.1, 0.1)})};
  const auto found = JudgeMotion(Box("lid", false), screwed);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, kCannotMove);
  EXPECT_EQ(found[0].severity, Severity::kWarning);
  EXPECT_EQ(found[0].text,
            "'board' is to move by the name of 'lid', and no joint lets it, but 'screw' holds it "
            "fast to 'box'");
  EXPECT_THAT(JudgeMotion(Box("top", false), screwed), IsEmpty());
  EXPECT_THAT(JudgeMotion(Box("lid", false), {Held({})}), IsEmpty());
}

// As connecting has it: what its own design fastens stays so.
TEST(MotionRulesTest, WhatItsOwnDesignFastensStaysSo) {
  const std::vector<Joint> screwed{Held({Upright("screw", FastenerKind::kScrew, 0.1, 0.1)})};
  const auto judged = [&](const std::string& design_of_screw) {
    return JudgeMotion(Box("lid", false), screwed, [&](const std::string& part) {
      return part == "board" ? "shelf" : part == "screw" ? design_of_screw : "case";
    });
  };
  EXPECT_THAT(judged("shelf"), IsEmpty());
  EXPECT_THAT(judged("case"), SizeIs(1));
  EXPECT_THAT(judged(""), SizeIs(1));  // of a connection of another design
  // A joint says that it moves, whatever its design fastens.
  EXPECT_THAT(JudgeMotion(Box("lid", true), screwed, [](const std::string&) { return "one"; }),
              SizeIs(1));
}

// That something else has a joint makes no difference to it.
TEST(MotionRulesTest, ALidBesideADoorIsToMove) {
  Assembly box = Box("lid", false);
  box.parts.push_back(FixedPart("door", {0, -0.02, 0}, {0.5, 0, 0.5}));
  box.groups.push_back({"front", 0});
  box.parts[1] = FixedPart("lid", {0, 0, 0.5}, {0.5, 0.5, 0.52});
  box.parts[2].group = 2;
  parametric::Joint& joint = box.joints.emplace_back();
  joint.name = "hinge";
  joint.group = 2;
  joint.axis = {0, 0, 1};
  Joint held = Held({Upright("screw", FastenerKind::kScrew, 0.1, 0.1)});
  held.principals[1].name = "lid";
  const auto found = JudgeMotion(box, {held});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, kCannotMove);
  EXPECT_THAT(found[0].text, HasSubstr("'lid' is to move by its name, and no joint lets it"));
}

// Experts drew them: all that is to move can.
TEST(MotionRulesTest, NothingThatShipsIsHeldFast) {
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    SCOPED_TRACE(id);
    const Assembly& drawn = ShippedDesign(id).assembly->assembly();
    const auto found = JudgeMotion(drawn, JointsOf(drawn, ShippedConnections(id),
                                                   parametric::ShippedItems(), ShippedMaterials()));
    for (const Finding& finding : found) ADD_FAILURE() << finding.rule << ": " << finding.text;
  }
}

// A screw from the case into a drawer that ships.
TEST(MotionRulesTest, AScrewMoreHoldsADrawer) {
  Assembly cart = ShippedDesign("tool_cart").assembly->assembly();
  const auto named = [&](const std::string& name) -> const parametric::AssemblyPart& {
    return *std::find_if(cart.parts.begin(), cart.parts.end(),
                         [&](const auto& part) { return part.name == name; });
  };
  const parametric::BoundingBox side = named("drawer side 1").box;
  parametric::AssemblyPart screw = named("drawer screw left 1");
  screw.name = "screw more";
  screw.box.minimum.x() = named("upright 1.1").box.minimum.x();
  screw.box.maximum.x() = side.maximum.x();
  screw.item_axes[0] = Axis::kX;
  screw.box.minimum.y() = 0.013;
  screw.box.maximum.y() = 0.017;
  screw.box.minimum.z() = side.center().z() + 0.04;
  screw.box.maximum.z() = screw.box.minimum.z() + 0.004;
  cart.parts.push_back(screw);
  ASSERT_OK_AND_ASSIGN(const auto connections, ConnectionsOf("assemblies/cart", cart));
  const auto found = JudgeMotion(
      cart, JointsOf(cart, connections, parametric::ShippedItems(), ShippedMaterials()));
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, kScrewedFast);
  EXPECT_THAT(found[0].parts, ElementsAre("drawer side 1"));
  EXPECT_THAT(found[0].text, HasSubstr("'screw more'"));
}

}  // namespace
}  // namespace mortise::composer
