#include "services/fabplanner/joining/assembly_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <stop_token>

#include "services/fabplanner/joining/assembly_sequence.h"
#include "services/fabplanner/joining/part_solid.h"
#include "services/fabplanner/joining/taking_apart.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

Part Block(const std::string& name, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  return BoxPart(name, "items/plywood-18", CutProcess::kJigsaw, lower, upper, 0, 2);
}

std::vector<AssemblyStep> StepsOf(const Design& design) {
  const auto steps = OrderedSteps(design, ExampleItems(), {});
  EXPECT_TRUE(steps.ok()) << steps.status();
  return steps.ok() ? *steps : std::vector<AssemblyStep>();
}

// The number of the step with which a part comes in.
int StepOf(const std::vector<AssemblyStep>& steps, const std::string& part) {
  int found = 0;
  for (const AssemblyStep& step : steps) {
    for (const auto* names : {&step.added_parts, &step.connectors}) {
      if (std::count(names->begin(), names->end(), part) == 0) continue;
      EXPECT_EQ(found, 0) << part << " comes in twice";
      found = step.number;
    }
  }
  EXPECT_GT(found, 0) << part << " does not come in";
  return found;
}

TEST(AssemblyOrderTest, ScrewsComeWithTheLastPartTheyHold) {
  const Design design = ExampleRack();
  const std::vector<AssemblyStep> steps = StepsOf(design);
  for (const Part& part : design.parts) StepOf(steps, part.name);
  EXPECT_EQ(steps.front().added_parts.front(), "side 1");
  EXPECT_EQ(StepOf(steps, "shelf 1 screw left"), StepOf(steps, "shelf 1"));
  EXPECT_EQ(StepOf(steps, "shelf 1 screw right"), StepOf(steps, "side 2"));
  EXPECT_GT(StepOf(steps, "side 2"), StepOf(steps, "shelf 2"));
  EXPECT_THAT(steps.back().instruction, HasSubstr("side 2 in place from the right"));
  EXPECT_THAT(steps.back().instruction, HasSubstr("2 × Wood screw 4 × 40"));
}

TEST(AssemblyOrderTest, SubAssembliesComeFirstAndThenInOnePiece) {
  Design design = ExampleRack();
  design.groups.push_back({"box", 0});
  const double x = 0.1;
  design.parts.push_back(Block("floor", {x, 0, 0.318}, {x + 0.2, 0.3, 0.33}));
  design.parts.push_back(Block("wall", {x, 0, 0.33}, {x + 0.02, 0.3, 0.5}));
  design.parts.push_back(ScrewPart("box screw", {x + 0.01, 0.1, 0.318}, 2, 1));
  for (std::size_t i = 8; i < 11; ++i) design.parts[i].group = 1;
  const std::vector<AssemblyStep> steps = StepsOf(design);
  EXPECT_EQ(steps[0].subassembly, "box");
  EXPECT_THAT(steps[0].connectors, ElementsAre("box screw"));
  const AssemblyStep& joining = steps.back();
  EXPECT_EQ(joining.subassembly, "");
  const auto moved = std::find_if(joining.moves.begin(), joining.moves.end(),
                                  [](const AssemblyStep::Move& m) { return m.parts.size() == 3; });
  ASSERT_NE(moved, joining.moves.end());
  EXPECT_THAT(moved->parts, UnorderedElementsAre("floor", "wall", "box screw"));
  EXPECT_EQ(moved->way_in, Eigen::Vector3d::UnitY());  // shelves are above and below
  EXPECT_THAT(joining.added_parts, IsEmpty());
  EXPECT_THAT(joining.instruction, HasSubstr("the box in place from the front"));
}

// Boards that are glued where they touch have an order too, if somebody drew them so.
TEST(AssemblyOrderTest, PartsThatOnlyTouchAreBuiltIfTheyAreDrawn) {
  Design design;
  design.parts.push_back(Block("seat", {0, 0, 0.4}, {1, 0.3, 0.418}));
  design.parts.push_back(Block("left", {0, 0, 0}, {0.018, 0.3, 0.4}));
  design.parts.push_back(Block("right", {0.982, 0, 0}, {1, 0.3, 0.4}));
  EXPECT_FALSE(HasOrderOfItsOwn(design));
  design.is_drawn = true;
  ASSERT_TRUE(HasOrderOfItsOwn(design));
  const std::vector<AssemblyStep> steps = StepsOf(design);
  for (const Part& part : design.parts) StepOf(steps, part.name);
}

// A frame whose pegs go both ways comes together as two pieces.
TEST(AssemblyOrderTest, WhatComesOffOnlyTogetherIsBuiltByItself) {
  Design design;
  const double leg = 0.05, length = 1, width = 0.5;
  for (int i = 0; i < 4; ++i) {
    const double x = i % 2 * (length - leg), y = i / 2 * (width - leg);
    design.parts.push_back(Block("leg " + std::to_string(i), {x, y, 0}, {x + leg, y + leg, 0.7}));
  }
  for (int i = 0; i < 2; ++i) {
    const double y = i * (width - leg), x = i * (length - leg);
    const std::string number = std::to_string(i);
    design.parts.push_back(Block("long " + number, {leg, y, 0.6}, {length - leg, y + leg, 0.7}));
    design.parts.push_back(Block("short " + number, {x, leg, 0.6}, {x + leg, width - leg, 0.7}));
    for (int end = 0; end < 2; ++end) {
      const double along_x = end == 0 ? leg : length - leg, along_y = end == 0 ? leg : width - leg;
      const std::string name = "dowel " + number + std::to_string(end);
      design.parts.push_back(ScrewPart("long " + name, {along_x - 0.0175, y + leg / 2, 0.65}, 0, 1,
                                       0.035, 0.008, "items/dowel-8x35"));
      design.parts.push_back(ScrewPart("short " + name, {x + leg / 2, along_y - 0.0175, 0.65}, 1, 1,
                                       0.035, 0.008, "items/dowel-8x35"));
    }
  }
  const std::vector<AssemblyStep> steps = StepsOf(design);
  for (const Part& part : design.parts) StepOf(steps, part.name);
  int pegs = 0, pieces = 0;
  for (const AssemblyStep& step : steps) {
    EXPECT_THAT(step.instruction, Not(HasSubstr("No straight movement"))) << step.number;
    pegs += step.pegs;
    for (const AssemblyStep::Move& move : step.moves) {
      if (move.parts.size() > 1 && !move.way_in.isZero()) ++pieces;
    }
  }
  EXPECT_EQ(pegs, 8);
  EXPECT_GE(pieces, 1);
}

// An open ring of bars of 0.1 m; its mouth is half as wide as a bar.
Part Ring(const std::string& name, int axis, const Eigen::Vector2d& lower,
          const Eigen::Vector2d& upper, double from) {
  Part ring = Block(name, {0, 0, 0}, {1, 1, 0.1});
  const double bar = 0.1, middle = (lower.y() + upper.y()) / 2, half_mouth = 0.025;
  ring.extrusion_axis = axis;
  ring.outline = {{upper.x(), middle + half_mouth},
                  {upper.x(), upper.y()},
                  {lower.x(), upper.y()},
                  {lower.x(), lower.y()},
                  {upper.x(), lower.y()},
                  {upper.x(), middle - half_mouth},
                  {upper.x() - bar, middle - half_mouth},
                  {upper.x() - bar, lower.y() + bar},
                  {lower.x() + bar, lower.y() + bar},
                  {lower.x() + bar, upper.y() - bar},
                  {upper.x() - bar, upper.y() - bar},
                  {upper.x() - bar, middle + half_mouth}};
  ring.from = from;
  ring.to = from + bar;
  return ring;
}

TEST(AssemblyOrderTest, PartsThatBlockEachOtherAreNamed) {
  // Two links of a chain: one upright in (z, x), one level in (x, y) around its left bar.
  Design design;
  design.parts.push_back(Ring("link one", 1, {0, 0}, {1, 1}, 0));
  design.parts.push_back(Ring("link two", 2, {-0.3, -0.3}, {0.5, 0.4}, 0.45));
  const std::vector<AssemblyStep> steps = StepsOf(design);
  for (const Part& part : design.parts) StepOf(steps, part.name);
  ASSERT_EQ(steps.size(), 1);
  EXPECT_THAT(steps[0].instruction, HasSubstr("each stands in another's way"));
  EXPECT_THAT(steps[0].instruction, HasSubstr("link one"));
  EXPECT_THAT(steps[0].instruction, HasSubstr("link two"));
}

TEST(AssemblyOrderTest, GroupsThatDoNotComeTogetherAreNotBuiltByThemselves) {
  // Two frames of four bars each, one through the other: only as bars they come together.
  Design design;
  const auto add_frame = [&](const std::string& name, const Eigen::Vector3d& lower,
                             const Eigen::Vector3d& upper, int along) {
    design.groups.push_back({name, 0});
    for (int side = 0; side < 2; ++side) {
      Eigen::Vector3d from = lower, to = upper;
      from.z() = side == 0 ? lower.z() : upper.z() - 0.1;
      to.z() = from.z() + 0.1;
      Part bar = Block(name + " bar " + std::to_string(side), from, to);
      from = lower;
      to = upper;
      from[along] = side == 0 ? lower[along] : upper[along] - 0.1;
      to[along] = from[along] + 0.1;
      from.z() += 0.1;
      to.z() -= 0.1;
      Part post = Block(name + " post " + std::to_string(side), from, to);
      for (Part* part : {&bar, &post}) {
        part->group = static_cast<int>(design.groups.size()) - 1;
        design.parts.push_back(*part);
      }
    }
  };
  add_frame("one", {0, 0, 0}, {1, 0.1, 1}, 0);
  add_frame("two", {0.45, -0.5, 0.4}, {0.55, 0.55, 1.5}, 1);
  const std::vector<AssemblyStep> steps = StepsOf(design);
  for (const Part& part : design.parts) StepOf(steps, part.name);
  for (const AssemblyStep& step : steps) {
    EXPECT_THAT(step.instruction, Not(HasSubstr("each stands in another's way"))) << step.number;
  }
}

TEST(AssemblyOrderTest, OrderOfPartsDoesNotMatterToWhatIsAdded) {
  std::mt19937 random(7);
  Design design = ExampleRack();
  const auto order_of = [](const Design& shuffled) {
    std::vector<std::vector<std::string>> order;
    for (const AssemblyStep& step : StepsOf(shuffled)) {
      order.push_back(step.added_parts);
      std::sort(order.back().begin(), order.back().end());
    }
    return order;
  };
  EXPECT_EQ(order_of(design), order_of(design));
  for (int run = 0; run < 20; ++run) {
    std::shuffle(design.parts.begin(), design.parts.end(), random);
    const auto order = order_of(design);
    EXPECT_EQ(order.size(), 3);
  }
}

// Boxes on a grid without room between them always come apart, and the ways are free.
TEST(TakingApartTest, RandomPilesComeApart) {
  std::mt19937 random(11);
  for (int run = 0; run < 30; ++run) {
    Design design;
    std::uniform_int_distribution<int> coordinate(0, 5);
    std::map<std::tuple<int, int, int>, bool> filled;
    while (design.parts.size() < 12) {
      const int x = coordinate(random), y = coordinate(random), z = coordinate(random);
      if (filled[{x, y, z}]) continue;
      filled[{x, y, z}] = true;
      design.parts.push_back(Block("b" + std::to_string(design.parts.size()),
                                   {x * 0.1, y * 0.1, z * 0.1},
                                   {x * 0.1 + 0.1, y * 0.1 + 0.1, z * 0.1 + 0.1}));
    }
    std::vector<PartSolid> solids;
    std::vector<std::vector<int>> units;
    std::vector<int> all;
    std::vector<UnitFacts> facts;
    for (std::size_t i = 0; i < design.parts.size(); ++i) {
      solids.emplace_back(design.parts[i]);
      units.push_back({static_cast<int>(i)});
      all.push_back(static_cast<int>(i));
      facts.push_back(
          {"", false, false, 0, solids[i].box().min().z(), solids[i].box().max().z(), 1e-3});
    }
    const Joints joints = FindJoints(design, ExampleItems(), solids);
    const Blocking blocking(design, ExampleItems(), solids, joints, units);
    const TakenApart apart = TakeApart(all, facts, joints.touching, joints.touching, blocking);
    EXPECT_THAT(apart.stuck, IsEmpty());
    std::vector<int> left = all;
    for (const std::vector<Removal>& step : apart.steps) {
      for (const Removal& removal : step) {
        ASSERT_EQ(removal.units.size(), 1);
        const int unit = removal.units.front();
        for (int other : left) {
          EXPECT_FALSE(other != unit && blocking.Blocks(removal.direction, unit, other));
        }
        left.erase(std::find(left.begin(), left.end(), unit));
      }
    }
    EXPECT_THAT(left, ElementsAre(apart.base));
  }
}

// A wall of boxes, nothing fastened, so that each step has to keep all that is left in one piece.
Design Wall(int width, int height) {
  Design design;
  design.is_drawn = true;
  for (int i = 0; i < width * height; ++i) {
    const double x = 0.1 * (i % width), z = 0.1 * (i / width);
    design.parts.push_back(Block("b" + std::to_string(i), {x, 0, z}, {x + 0.1, 0.1, z + 0.1}));
  }
  return design;
}

TEST(TakingApartTest, WhatIsLeftHoldsTogether) {
  const std::vector<AssemblyStep> steps = StepsOf(Wall(7, 5));
  std::set<int> standing;
  for (const AssemblyStep& step : steps) {
    for (const std::string& name : step.added_parts) {
      const int part = std::stoi(name.substr(1));
      const bool touches = standing.empty() || standing.contains(part - 7) ||
                           standing.contains(part + 7) ||
                           (part % 7 > 0 && standing.contains(part - 1)) ||
                           (part % 7 < 6 && standing.contains(part + 1));
      EXPECT_TRUE(touches) << name << " in step " << step.number;
      standing.insert(part);
    }
  }
  EXPECT_EQ(standing.size(), 35u);
}

TEST(TakingApartTest, StopsWhenItIsAskedTo) {
  std::stop_source source;
  source.request_stop();
  EXPECT_TRUE(absl::IsCancelled(AssemblySteps(Wall(40, 40), {}, {}, source.get_token()).status()));
}

TEST(TakingApartTest, RefusesMorePartsThanItOrdersInTime) {
  const absl::Status status = AssemblySteps(Wall(3, 700), {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), AllOf(HasSubstr("2100"), HasSubstr("2000")));
}

TEST(PartSolidTest, ShapesAreJudgedByTheirFaces) {
  // A triangular prism: the half below the diagonal of a unit square in (x, y), 0.1 high.
  Part wedge = Block("wedge", {0, 0, 0}, {1, 1, 0.1});
  wedge.outline = {{0, 0}, {1, 0}, {1, 1}};
  const PartSolid solid(wedge);
  const std::vector<Stretch> inside = solid.Along(0, {0, 0.25, 0.05});
  ASSERT_EQ(inside.size(), 1);
  EXPECT_NEAR(inside[0].from, 0.25, 1e-6);
  EXPECT_NEAR(inside[0].to, 1, 1e-6);
  EXPECT_TRUE(solid.Along(0, {0, 1.25, 0.05}).empty());

  const PartSolid corner(Block("corner", {0, 0.8, 0}, {0.2, 1, 0.1}));  // in the other half
  EXPECT_TRUE(solid.box().intersects(corner.box()));
  EXPECT_FALSE(solid.Touches(corner));
  EXPECT_FALSE(solid.Overlaps(corner));
  EXPECT_FALSE(corner.IsBlockedBy(solid, 0, -1));
  EXPECT_TRUE(corner.IsBlockedBy(solid, 0, 1));  // the wedge's right edge is there
  EXPECT_FALSE(corner.IsBlockedBy(solid, 1, 1));
  EXPECT_TRUE(corner.IsBlockedBy(solid, 1, -1));
  EXPECT_FALSE(corner.IsBlockedBy(solid, 2, 1));  // nothing of the wedge above it

  const PartSolid under(Block("under", {0.7, 0.1, -0.1}, {0.8, 0.2, 0}));
  EXPECT_TRUE(solid.Touches(under));
  EXPECT_TRUE(under.Touches(solid));
  EXPECT_TRUE(under.IsBlockedBy(solid, 2, 1));
  EXPECT_FALSE(under.IsBlockedBy(solid, 2, -1));
  EXPECT_TRUE(PartSolid(Block("in", {0.7, 0.1, 0}, {0.8, 0.2, 0.05})).Overlaps(solid));
}

}  // namespace
}  // namespace mortise::fabplanner
