// Sub-trees by themselves: what belongs to a group, and what becomes of what crosses its border.
#include "common/assembly/sub_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/connections/connection_assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> PartsOf(const Assembly& assembly) {
  std::vector<std::string> names;
  for (const AssemblyPart& part : assembly.parts) names.push_back(part.name);
  return names;
}

// A chest whose parts are held together: each shelf by a dowel to the left side, the bottom to that
// by a bolt with a washer drawn at the root, and the lid to the top shelf by a hinge drawn in the
// case.
Assembly HeldChest() {
  Assembly chest = ChestWithLid();
  for (int i = 0; i < 3; ++i) {
    const double z = 0.15 + 0.15 * i;
    chest.parts.push_back(Fastener("dowel " + std::to_string(i + 1), {0.01, 0.2, z - 0.004},
                                   {0.05, 0.208, z + 0.004}, 2));
  }
  chest.parts.push_back(Fastener("bolt", {0.0, 0.2, 0.005}, {0.06, 0.21, 0.015}, 0));
  chest.parts.push_back(Fastener("washer", {-0.002, 0.19, 0.0}, {0.0, 0.22, 0.02}, 0));
  chest.parts.push_back(Fastener("hinge", {0.4, 0.5, 0.45}, {0.5, 0.505, 0.615}, 1));
  chest.parts.push_back(Fastener("label", {3, 0, 0}, {3.1, 0.1, 0.001}, 3));
  return chest;
}

TEST(SubTreeTest, TheRootIsTheWhole) {
  ASSERT_OK_AND_ASSIGN(const Assembly whole, SubTreeOf(HeldChest(), ""));
  EXPECT_EQ(PartsOf(whole), PartsOf(HeldChest()));
  EXPECT_EQ(whole.groups.size(), HeldChest().groups.size());
  EXPECT_EQ(whole.joints.size(), 1U);
}

TEST(SubTreeTest, AGroupKeepsItsGroupsAndPlaces) {
  ASSERT_OK_AND_ASSIGN(const Assembly made, SubTreeOf(ChestWithLid(), "case"));
  EXPECT_EQ(made.name, "chest");
  EXPECT_THAT(PartsOf(made),
              ElementsAre("left side", "right side", "bottom", "shelf 1", "shelf 2", "shelf 3"));
  ASSERT_EQ(made.groups.size(), 2U);
  EXPECT_EQ(made.groups[1].name, "shelves");
  EXPECT_EQ(made.groups[1].parent, 0);
  EXPECT_EQ(made.parts[0].group, 0);
  EXPECT_EQ(made.parts[3].group, 1);
  EXPECT_EQ(made.parts[3].box.minimum, ChestWithLid().parts[3].box.minimum);
  EXPECT_THAT(made.joints, IsEmpty());
  EXPECT_THAT(ValidateAssembly(made), IsEmpty());
}

// Wherever they are drawn: the bolt, and the washer that only touches it, hold what is inside.
TEST(SubTreeTest, WhatHoldsOnlyWhatIsInsideComesAlong) {
  ASSERT_OK_AND_ASSIGN(const Assembly made, SubTreeOf(HeldChest(), "case"));
  EXPECT_THAT(PartsOf(made),
              ElementsAre("left side", "right side", "bottom", "shelf 1", "shelf 2", "shelf 3",
                          "dowel 1", "dowel 2", "dowel 3", "bolt", "washer"));
  EXPECT_EQ(made.parts.back().group, 0);
  EXPECT_THAT(ValidateAssembly(made), IsEmpty());
}

// The hinge is drawn in the case and holds the lid; the dowels are drawn with the shelves.
TEST(SubTreeTest, WhatCrossesTheBorderIsLeftOut) {
  ASSERT_OK_AND_ASSIGN(const Assembly shelves, SubTreeOf(HeldChest(), "shelves"));
  EXPECT_THAT(PartsOf(shelves), ElementsAre("shelf 1", "shelf 2", "shelf 3"));
  // What touches nothing stays with its group.
  ASSERT_OK_AND_ASSIGN(const Assembly lid, SubTreeOf(HeldChest(), "lid"));
  EXPECT_THAT(PartsOf(lid), ElementsAre("lid board", "label"));
}

TEST(SubTreeTest, JointsStayThatMoveSomethingInside) {
  Assembly chest = HeldChest();
  // The whole chest as a group of a room.
  chest.groups.push_back({"room", 0});
  const int room = static_cast<int>(chest.groups.size()) - 1;
  for (const int group : {1, 3}) chest.groups[static_cast<std::size_t>(group)].parent = room;
  Joint rolls;
  rolls.name = "rolls";
  rolls.kind = JointKind::kPrismatic;
  rolls.group = room;
  rolls.axis = Eigen::Vector3d::UnitX();
  rolls.upper = 1;
  chest.joints.push_back(rolls);
  ASSERT_OK_AND_ASSIGN(const Assembly made, SubTreeOf(chest, "room"));
  ASSERT_EQ(made.joints.size(), 1U);
  EXPECT_EQ(made.joints[0].name, "lid hinge");
  EXPECT_EQ(made.groups[static_cast<std::size_t>(made.joints[0].group)].name, "lid");
  EXPECT_THAT(ValidateAssembly(made), IsEmpty());
}

TEST(SubTreeTest, PartsAndRowsAreSubTreesToo) {
  ASSERT_OK_AND_ASSIGN(const Assembly part, SubTreeOf(HeldChest(), "shelf 2"));
  EXPECT_THAT(PartsOf(part), ElementsAre("shelf 2"));
  EXPECT_EQ(part.groups.size(), 1U);
  EXPECT_EQ(part.parts[0].group, 0);
  ASSERT_OK_AND_ASSIGN(const Assembly row, SubTreeOf(HeldChest(), "shelf"));
  EXPECT_THAT(PartsOf(row), ElementsAre("shelf 1", "shelf 2", "shelf 3"));
  Assembly grid = Named("grid", {ResizablePart("tile 1.1", {0, 0, 0}, {0.1, 0.1, 0.01}),
                                 ResizablePart("tile 1.2", {0.2, 0, 0}, {0.3, 0.1, 0.01}),
                                 ResizablePart("tile 1.b", {0.4, 0, 0}, {0.5, 0.1, 0.01}),
                                 ResizablePart("tiles", {0.6, 0, 0}, {0.7, 0.1, 0.01})});
  ASSERT_OK_AND_ASSIGN(const Assembly tiles, SubTreeOf(grid, "tile"));
  EXPECT_THAT(PartsOf(tiles), ElementsAre("tile 1.1", "tile 1.2"));
}

TEST(SubTreeTest, WhatThereIsNotIsRefused) {
  for (const char* name : {"drawer", "chest", "shel", "shelf ", "Case"}) {
    const absl::Status refused = SubTreeOf(HeldChest(), name).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_EQ(DetailOf(refused).field, "group") << name;
    EXPECT_THAT(std::string(refused.message()), HasSubstr("there is no group or part")) << name;
  }
  const absl::Status empty = SubTreeOf(HeldChest(), "bolt").status();
  EXPECT_EQ(DetailOf(empty).field, "group");
  EXPECT_THAT(std::string(empty.message()), HasSubstr("no principal parts"));
}

TEST(SubTreeTest, ASubTreeIsParametrisedAsAnyAssembly) {
  ASSERT_OK_AND_ASSIGN(Assembly sub_tree, SubTreeOf(HeldChest(), "case"));
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly made,
                       ParametricAssembly::Create(std::move(sub_tree)));
  ASSERT_OK_AND_ASSIGN(const Adjustment wider,
                       made.Meet({{{"bottom", Axis::kX, MeasureKind::kSize}, 1.1}}));
  ASSERT_OK_AND_ASSIGN(const std::vector<ContactFault> faults, made.FaultsAt(wider.q));
  EXPECT_THAT(faults, IsEmpty());
  EXPECT_FALSE(made.RangeOf({"lid board", Axis::kX, MeasureKind::kSize}).ok());
}

TEST(PartsOfNodeTest, TheyAreThoseDrawnBelowIt) {
  ASSERT_OK_AND_ASSIGN(const std::vector<std::string> lid, PartsOfNode(HeldChest(), "lid"));
  EXPECT_THAT(lid, ElementsAre("lid board", "label"));
  ASSERT_OK_AND_ASSIGN(const std::vector<std::string> row, PartsOfNode(HeldChest(), "shelf"));
  EXPECT_THAT(row, ElementsAre("shelf 1", "shelf 2", "shelf 3"));
  ASSERT_OK_AND_ASSIGN(const std::vector<std::string> all, PartsOfNode(HeldChest(), ""));
  EXPECT_EQ(all.size(), HeldChest().parts.size());
  EXPECT_EQ(DetailOf(PartsOfNode(HeldChest(), "drawer").status()).field, "group");
}

TEST(WithoutSubTreeTest, WhatHeldItGoesToo) {
  ASSERT_OK_AND_ASSIGN(const Assembly open, WithoutSubTree(HeldChest(), "lid"));
  EXPECT_THAT(PartsOf(open),
              ElementsAre("left side", "right side", "bottom", "shelf 1", "shelf 2", "shelf 3",
                          "dowel 1", "dowel 2", "dowel 3", "bolt", "washer"));
  EXPECT_THAT(open.joints, IsEmpty());
  for (const AssemblyGroup& group : open.groups) EXPECT_NE(group.name, "lid");
  EXPECT_THAT(ValidateAssembly(open), IsEmpty());
}

TEST(WithoutSubTreeTest, ThePartOfARowTakesItsOwnFasteners) {
  ASSERT_OK_AND_ASSIGN(const Assembly made, WithoutSubTree(HeldChest(), "shelf 2"));
  EXPECT_THAT(PartsOf(made),
              ElementsAre("left side", "right side", "bottom", "shelf 1", "shelf 3", "lid board",
                          "dowel 1", "dowel 3", "bolt", "washer", "hinge", "label"));
  EXPECT_EQ(made.joints.size(), 1U);
  EXPECT_EQ(made.groups.size(), HeldChest().groups.size());
  EXPECT_THAT(ValidateAssembly(made), IsEmpty());
}

// A screw from below through a beam into a shaft, up to the floor that lies on that.
TEST(WithoutSubTreeTest, WhatOnlyLiesAgainstItStays) {
  Assembly cart = Named("cart", {ResizablePart("beam", {0, 0, 0}, {0.1, 1, 0.06}),
                                 ResizablePart("shaft", {0, 0, 0.06}, {0.1, 1, 0.15}),
                                 ResizablePart("floor", {0, 0, 0.15}, {0.1, 1, 0.162}),
                                 ResizablePart("screw", {0.04, 0.5, 0.03}, {0.046, 0.506, 0.15}),
                                 ResizablePart("plate", {0.1, 0, 0.05}, {0.103, 0.1, 0.162})});
  for (const std::size_t connecting : {3, 4}) cart.parts[connecting].connecting = true;
  ASSERT_OK_AND_ASSIGN(const Assembly made, WithoutSubTree(cart, "floor"));
  // The plate lies against all three, and reaches into none of them.
  EXPECT_THAT(PartsOf(made), ElementsAre("beam", "shaft", "screw"));
  ASSERT_OK_AND_ASSIGN(const Assembly without_shaft, WithoutSubTree(cart, "shaft"));
  EXPECT_THAT(PartsOf(without_shaft), ElementsAre("beam", "floor"));
}

// The sub-tree and what is left without it share no part, and what is in neither held them
// together.
TEST(WithoutSubTreeTest, ItIsTheOtherSideOfTheSubTree) {
  for (const char* node : {"case", "shelves", "lid", "shelf 1", "bottom"}) {
    ASSERT_OK_AND_ASSIGN(const Assembly inside, SubTreeOf(HeldChest(), node));
    ASSERT_OK_AND_ASSIGN(const Assembly outside, WithoutSubTree(HeldChest(), node));
    std::multiset<std::string> both;
    for (const Assembly* half : {&inside, &outside}) {
      for (const std::string& name : PartsOf(*half)) both.insert(name);
    }
    for (const AssemblyPart& part : HeldChest().parts) {
      EXPECT_LE(both.count(part.name), 1U) << part.name;
      if (!part.connecting) {
        EXPECT_EQ(both.count(part.name), 1U) << part.name;
      }
    }
  }
}

TEST(WithoutSubTreeTest, WhatCannotGoIsRefused) {
  EXPECT_EQ(DetailOf(WithoutSubTree(HeldChest(), "drawer").status()).field, "group");
  const absl::Status fastener = WithoutSubTree(HeldChest(), "bolt").status();
  EXPECT_EQ(DetailOf(fastener).field, "group");
  EXPECT_THAT(std::string(fastener.message()), HasSubstr("no principal parts"));
  EXPECT_EQ(DetailOf(WithoutSubTree(HeldChest(), "").status()).reason, "NOTHING_LEFT");
}

// Two drawers that look the same, a third one that is wider, and a group of one part.
TEST(DistinctSubTreesTest, OfThoseThatLookTheSameTheFirstStandsForAll) {
  Assembly chest;
  chest.name = "chest";
  chest.groups = {{"chest", -1}, {"upper", 0}, {"lower", 0}, {"wide", 0}, {"lid", 0}};
  for (int drawer = 0; drawer < 3; ++drawer) {
    const double z = 0.3 * drawer, width = drawer == 2 ? 0.6 : 0.5;
    const std::string number = std::to_string(drawer);
    chest.parts.push_back(
        ResizablePart("front " + number, {0, 0, z}, {width, 0.02, z + 0.2}, drawer + 1));
    chest.parts.push_back(
        ResizablePart("bottom " + number, {0, 0.02, z}, {width, 0.4, z + 0.01}, drawer + 1));
  }
  chest.parts.push_back(ResizablePart("lid", {0, 0, 0.9}, {0.6, 0.4, 0.92}, 4));
  EXPECT_THAT(DistinctSubTrees(chest), ElementsAre("upper", "wide"));
}

TEST(DistinctSubTreesTest, TheWholeIsNone) {
  EXPECT_THAT(DistinctSubTrees(TwoLeggedTable()), IsEmpty());
  Assembly table = TwoLeggedTable();
  table.groups.push_back({"all of it", 0});
  for (AssemblyPart& part : table.parts) part.group = 1;
  EXPECT_THAT(DistinctSubTrees(table), IsEmpty());
}

}  // namespace
}  // namespace mortise::parametric
