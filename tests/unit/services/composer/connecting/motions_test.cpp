// What components are to do against what they are connected to, in designs that ship.
#include "services/composer/connecting/motions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/connections/connection_optimizer.h"
#include "common/assembly/model/rest_pose.h"
#include "services/composer/connecting/component_motion.h"
#include "services/composer/model/removal.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::JointKind;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::string JointOf(const std::string& id, const std::string& node) {
  const parametric::Joint* const joint = OwnJointOf(ShippedDesign(id).assembly->assembly(),
                                                    PrincipalPartsOf(ShippedComponent(id, node)));
  return joint == nullptr ? "" : joint->name;
}

TEST(MotionsTest, NamesSayWhatIsToMove) {
  for (const char* name : {"drawer", "left door", "left-door", "Top Drawer 2", "lid", "flap 1.2"}) {
    EXPECT_TRUE(IsMeantToMove(name)) << name;
  }
  for (const char* name : {"", "12", "drawer side 1", "door frame", "slide", "solid", "doors",
                           "desk-with-drawer", "shelf with door 2", "hinge for lid"}) {
    EXPECT_FALSE(IsMeantToMove(name)) << name;
  }
}

TEST(MotionsTest, AJointIsOfAllThatItMovesAndOfNothingElse) {
  EXPECT_EQ(JointOf("cabinet", "left drawer"), "left drawer slide");
  EXPECT_EQ(JointOf("cabinet", "right door"), "right door hinge");
  EXPECT_EQ(JointOf("chicken_coop", "pop door"), "pop door");
  EXPECT_EQ(JointOf("cabinet", "left drawer front"), "");
  EXPECT_EQ(JointOf("cabinet", "case"), "");
  EXPECT_EQ(JointOf("bookshelf", "shelf 3"), "");
}

// Slides, hinges and screws, by which part of the pair is the component's.
TEST(MotionsTest, ConnectionsAllowOneMotion) {
  int slides = 0, hinges = 0, firm = 0;
  for (const CollectionConnection& one : ShippedConnections("cabinet")) {
    if (one.connection.connecting.empty()) continue;
    const int last = one.connection.principal_count() - 1;
    const AllowedMotion there =
        AllowedMotionOf(one.connection, 0, last, ShippedOptions().item_kind_of);
    const AllowedMotion back =
        AllowedMotionOf(one.connection, last, 0, ShippedOptions().item_kind_of);
    const auto allows = [&](const WantedMotion& wanted) {
      return Allows(there, wanted) || Allows(back, wanted);
    };
    const bool is_slide = allows({true, JointKind::kPrismatic});
    const bool is_hinge = allows({true, JointKind::kHinge});
    EXPECT_EQ(is_slide + is_hinge + allows({}), 1) << one.connection.name;
    EXPECT_EQ(allows({true, std::nullopt}), is_slide || is_hinge);
    EXPECT_FALSE(Allows(there, {true, std::nullopt}) && Allows(back, {true, std::nullopt}))
        << one.connection.name;
    slides += is_slide;
    hinges += is_hinge;
    firm += allows({});
  }
  EXPECT_GE(slides, 2);
  EXPECT_EQ(hinges, 2);
  EXPECT_GE(firm, 4);
}

int IndexOf(const std::vector<PrincipalPart>& parts, const std::string& name) {
  return static_cast<int>(std::find_if(parts.begin(), parts.end(),
                                       [&](const auto& part) { return part.name == name; }) -
                          parts.begin());
}

TEST(MotionsTest, AShelfIsFastenedToTheCaseOrToADoor) {
  const BothSides sides =
      SidesOf(ShippedDesign("cabinet"), ShippedComponent("bookshelf", "shelf 3"));
  const int side = IndexOf(sides.body_parts, "side 1"), top = IndexOf(sides.body_parts, "top");
  const int door = IndexOf(sides.body_parts, "left door");
  MovingFrames frames(sides);
  EXPECT_TRUE(frames.BothStay(side, 0));
  EXPECT_FALSE(frames.BothStay(door, 0));
  EXPECT_TRUE(frames.MayFasten(door, 0));
  frames.Fasten(side, 0);
  EXPECT_TRUE(frames.MayFasten(top, 0));
  EXPECT_FALSE(frames.MayFasten(door, 0));
  MovingFrames others(sides);
  others.Fasten(door, 0);
  EXPECT_FALSE(others.MayFasten(side, 0));
}

absl::StatusOr<Connected> ConnectAs(const std::string& id, const Design& body,
                                    const Design& component, const Original* original) {
  return Connect(body, component, id, original, AllShippedConnections(), ShippedOptions());
}

absl::StatusOr<Design> Without(const std::string& id, const std::string& node) {
  MORTISE_ASSIGN_OR_RETURN(parametric::Assembly rest, WithoutNode(ShippedDesign(id), node));
  return AsDrawn(std::move(rest));
}

int FastenedConnections(const Connected& made) {
  return static_cast<int>(std::count_if(made.connections.begin(), made.connections.end(),
                                        [](const auto& one) { return !one.parts.empty(); }));
}

// Nothing but its name tells what it is to do; and of what the design says, its connections do.
TEST(MotionsTest, WhatIsCalledADrawerGetsSlides) {
  ASSERT_OK_AND_ASSIGN(const Design cart, Without("tool_cart", "drawer"));
  const Design drawer = ShippedComponent("tool_cart", "drawer");
  ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("my-drawer", cart, drawer, nullptr));
  EXPECT_EQ(FastenedConnections(made), 2);
  EXPECT_THAT(made.warnings, IsEmpty());
  const parametric::Assembly& assembly = made.model.assembly->assembly();
  ASSERT_THAT(assembly.joints, SizeIs(1));
  EXPECT_EQ(assembly.joints[0].kind, JointKind::kPrismatic);
  EXPECT_EQ(assembly.groups[static_cast<std::size_t>(assembly.joints[0].group)].name, "my-drawer");
}

TEST(MotionsTest, WhatIsCalledADoorGetsHinges) {
  ASSERT_OK_AND_ASSIGN(const Design cabinet, Without("cabinet", "left door"));
  const Design door = ShippedComponent("cabinet", "left door");
  ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("my-door", cabinet, door, nullptr));
  EXPECT_EQ(FastenedConnections(made), 1);
  EXPECT_THAT(made.warnings, IsEmpty());
  const auto& joints = made.model.assembly->assembly().joints;
  EXPECT_EQ(std::count_if(joints.begin(), joints.end(),
                          [](const auto& joint) { return joint.kind == JointKind::kHinge; }),
            2);
}

// What nothing is known of is to stay, and is not put on slides.
TEST(MotionsTest, WhatIsNotIsHeldFirmly) {
  ASSERT_OK_AND_ASSIGN(const Design cart, Without("tool_cart", "drawer"));
  const Design drawer = ShippedComponent("tool_cart", "drawer");
  const auto made = ConnectAs("crate", cart, drawer, nullptr);
  if (made.ok()) {
    EXPECT_THAT(made->model.assembly->assembly().joints, IsEmpty());
  }
}

// What its design screws is screwed here, too, by the same screws, and nobody warns of that.
TEST(MotionsTest, AShelfThatIsCalledADrawerIsAShelf) {
  ASSERT_OK_AND_ASSIGN(const Design bookshelf, Without("bookshelf", "shelf 3"));
  const Design shelf = ShippedComponent("bookshelf", "shelf 3");
  const Original original = ShippedOriginal("bookshelf");
  ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("drawer", bookshelf, shelf, &original));
  EXPECT_EQ(FastenedConnections(made), 2);
  EXPECT_THAT(made.warnings, IsEmpty());
}

// A design whose hinges are drawn, and no joint.
parametric::Assembly WithoutJoints(const std::string& id) {
  parametric::Assembly drawn = ShippedDesign(id).assembly->assembly();
  drawn.joints.clear();
  return drawn;
}

Original OriginalOf(const parametric::Assembly& drawn) {
  return {drawn.name, AsDrawn(drawn).value(),
          std::make_shared<const std::vector<CollectionConnection>>(
              ConnectionsOf(drawn.name, drawn).value())};
}

// Hinges are nothing that holds a door firmly.
TEST(MotionsTest, ADoorOnHingesWithoutAJointIsToMove) {
  const parametric::Assembly drawn = WithoutJoints("cabinet");
  const Original original = OriginalOf(drawn);
  ASSERT_OK_AND_ASSIGN(const Design door,
                       AsDrawn(parametric::SubTreeOf(drawn, "left door").value()));
  ASSERT_OK_AND_ASSIGN(const Design cabinet, Without("cabinet", "left door"));
  const ComponentMotion motion(SidesOf(cabinet, door), "my-door", &original,
                               ShippedOptions().item_kind_of);
  EXPECT_TRUE(motion.wanted().moves);
  // Without kinds of items they may be brackets.
  EXPECT_FALSE(
      ComponentMotion(SidesOf(cabinet, door), "my-door", &original, nullptr).wanted().moves);
  ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("my-door", cabinet, door, &original));
  EXPECT_EQ(FastenedConnections(made), 1);
  EXPECT_THAT(made.warnings, IsEmpty());
}

// The connection of a design that holds those two parts, with connecting parts.
const CollectionConnection& Holding(const std::string& id, const std::string& first,
                                    const std::string& second) {
  for (const CollectionConnection& one : ShippedConnections(id)) {
    const std::vector<std::string> names = one.Principals();
    const std::set<std::string> principals(names.begin(), names.end());
    if (principals == std::set<std::string>{first, second} && !one.connection.connecting.empty()) {
      return one;
    }
  }
  throw std::invalid_argument(first + " and " + second);
}

// Whatever design hinges are of: their axis is that of the ones before.
TEST(MotionsTest, AllHingesTurnAboutOneAxis) {
  const CollectionConnection& hinges = Holding("cabinet", "side 1", "left door");
  ASSERT_OK_AND_ASSIGN(const Design cabinet, Without("cabinet", "left door"));
  const BothSides sides = SidesOf(cabinet, ShippedComponent("cabinet", "left door"));
  const Original original = ShippedOriginal("cabinet");
  ComponentMotion motion(sides, "left-door", &original, ShippedOptions().item_kind_of);
  Candidate candidate{&hinges, {}};
  for (const std::string& name : hinges.Principals()) {
    const bool is_door = name == "left door";
    candidate.principals.push_back(
        {is_door, IndexOf(is_door ? sides.component_parts : sides.body_parts, name)});
  }
  const parametric::ConnectionOptimizer optimizer(hinges.connection);
  ASSERT_OK_AND_ASSIGN(parametric::OptimizedConnection placed,
                       optimizer.Optimize(sides.BoxesOf(candidate)));
  EXPECT_EQ(motion.WhyNotHeld(candidate, sides), "");
  EXPECT_EQ(motion.WhyNotMoved(candidate, placed), "");
  motion.Take(candidate, placed);
  EXPECT_TRUE(motion.IsLetMove());
  EXPECT_EQ(motion.WhyNotMoved(candidate, placed), "");
  const int center = parametric::JointVariable(hinges.connection.elements.size(), 0, Axis::kX);
  placed.q[center] += 0.01;
  EXPECT_THAT(motion.WhyNotMoved(candidate, placed), HasSubstr("in another way"));
}

// A board that its design screws to a side and a door's leaf at once, as if that were no door.
TEST(MotionsTest, NoConnectionFastensWhatMovesToWhatStays) {
  const BothSides sides =
      SidesOf(ShippedDesign("cabinet"), ShippedComponent("bookshelf", "shelf 3"));
  CollectionConnection screws = Holding("bookshelf", "side 1", "shelf 3");
  const int side = IndexOf(sides.body_parts, "side 1");
  const int door = IndexOf(sides.body_parts, "left door");
  const bool shelf_is_first = screws.Principals().front() == "shelf 3";
  const auto bound = [&](int part) {
    Candidate candidate{&screws, {{false, part}, {true, 0}}};
    if (shelf_is_first) std::swap(candidate.principals[0], candidate.principals[1]);
    return candidate;
  };
  const Original original = ShippedOriginal("bookshelf");  // which the screws are of
  ComponentMotion motion(sides, "shelf", &original, ShippedOptions().item_kind_of);
  EXPECT_EQ(motion.WhyNotHeld(bound(side), sides), "");
  EXPECT_EQ(motion.WhyNotHeld(bound(door), sides), "");
  motion.Take(bound(side), {});
  EXPECT_EQ(motion.WhyNotHeld(bound(side), sides), "");
  EXPECT_THAT(motion.WhyNotHeld(bound(door), sides),
              HasSubstr("it would hold 'shelf 3' fast to 'left door'"));
}

// Guides hold it by nothing but their place.
TEST(MotionsTest, ADoorBetweenGuidesTakesItsJointAlong) {
  ASSERT_OK_AND_ASSIGN(const Design coop, Without("chicken_coop", "pop door"));
  const Design door = ShippedComponent("chicken_coop", "pop door");
  const Original original = ShippedOriginal("chicken_coop");
  ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("pop-door", coop, door, &original));
  EXPECT_EQ(FastenedConnections(made), 0);
  EXPECT_THAT(made.warnings, IsEmpty());
  const parametric::Assembly& assembly = made.model.assembly->assembly();
  ASSERT_THAT(assembly.joints, SizeIs(2));
  EXPECT_EQ(assembly.joints[1].kind, JointKind::kPrismatic);
  EXPECT_EQ(assembly.groups[static_cast<std::size_t>(assembly.joints[1].group)].name, "pop-door");
}

// Beside one strip it would fall out.
TEST(MotionsTest, ADoorWithoutAllOfItsGuidesHasNoJoint) {
  const Design door = ShippedComponent("chicken_coop", "pop door");
  const Original original = ShippedOriginal("chicken_coop");
  for (const char* const guide : {"guide front", "guide rear"}) {
    ASSERT_OK_AND_ASSIGN(Design coop, Without("chicken_coop", "pop door"));
    ASSERT_OK_AND_ASSIGN(parametric::Assembly rest, WithoutNode(coop, guide));
    ASSERT_OK_AND_ASSIGN(coop, AsDrawn(std::move(rest)));
    ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("pop-door", coop, door, &original));
    EXPECT_THAT(made.model.assembly->assembly().joints, SizeIs(1));  // of the other door
    ASSERT_THAT(made.warnings, SizeIs(1));
    EXPECT_THAT(made.warnings[0].text,
                HasSubstr("'pop-door' is to slide by 'pop door', and nothing lets it"));
  }
}

// Drawers and a door on tables: screws between such boards are in the collection, and would hold
// them fast.
TEST(MotionsTest, WhatIsToMoveIsNotScrewedFast) {
  struct Scene {
    const char *body, *from, *node, *verb, *joint;
  };
  for (const Scene& scene :
       {Scene{"dining_table", "cabinet", "left drawer", "slide", "left drawer slide"},
        Scene{"dining_table", "cabinet", "left door", "turn", "left door hinge"},
        Scene{"workbench", "tool_cart", "drawer", "slide", "drawer slide"}}) {
    SCOPED_TRACE(std::string(scene.body) + " " + scene.node);
    const Design& body = ShippedDesign(scene.body);
    const parametric::BoundingBox box = BoundsOf(body);
    const Original original = ShippedOriginal(scene.from);
    const Design piece = ShippedComponent(scene.from, scene.node);
    const Eigen::Vector3d size = BoundsOf(piece).size();
    const Eigen::Vector3d above(0, 0, (box.size().z() + size.z()) / 2);
    const Design dropped = DroppedAt(piece, box.center() + above);
    ASSERT_OK_AND_ASSIGN(const Connected made, ConnectAs("piece", body, dropped, &original));
    EXPECT_EQ(FastenedConnections(made), 0);
    ASSERT_THAT(made.warnings, SizeIs(1));
    EXPECT_THAT(made.warnings[0].text, HasSubstr("'piece' is to " + std::string(scene.verb) +
                                                 " by '" + std::string(scene.joint) + "'"));
    EXPECT_LT(made.warnings[0].text.size(), 400U);
  }
}

}  // namespace
}  // namespace mortise::composer
