// The order of assembly where experts give priorities.
#include "services/fabplanner/joining/assembly_priorities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "services/fabplanner/joining/assembly_order.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

Part Board(const std::string& name, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper,
           int priority = 0) {
  Part part = BoxPart(name, "items/plywood-18", CutProcess::kJigsaw, lower, upper, 0, 2);
  part.priority = priority;
  return part;
}

Part& Named(const std::string& name, Design& design) {
  return *std::find_if(design.parts.begin(), design.parts.end(),
                       [&](const Part& part) { return part.name == name; });
}

std::vector<AssemblyStep> PrioritizedSteps(const Design& design) {
  const auto steps = OrderedSteps(design, ExampleItems(), {});
  EXPECT_TRUE(steps.ok()) << steps.status();
  return steps.ok() ? *steps : std::vector<AssemblyStep>();
}

// The number of the step with which a part or connector comes in; 0 for none.
int StepWith(const std::vector<AssemblyStep>& steps, const std::string& part) {
  for (const AssemblyStep& step : steps) {
    for (const auto* names : {&step.added_parts, &step.connectors}) {
      if (std::count(names->begin(), names->end(), part) > 0) return step.number;
    }
  }
  return 0;
}

std::string ContradictionIn(const Design& design) {
  const auto steps = OrderedSteps(design, ExampleItems(), {});
  EXPECT_FALSE(steps.ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(steps.status())) << steps.status();
  EXPECT_EQ(DetailOf(steps.status()).reason, "PRIORITIES_CONTRADICT");
  return std::string(steps.status().message());
}

// The rack of which the shelves are held to side 2 first.
TEST(AssemblyPriorities, OfConnectionsAreFollowed) {
  Design design = ExampleRack();
  EXPECT_GT(StepWith(PrioritizedSteps(design), "side 2"),
            StepWith(PrioritizedSteps(design), "side 1"));
  for (const std::string shelf : {"shelf 1", "shelf 2"}) {
    Named(shelf + " screw right", design).priority = 1;
    Named(shelf + " screw left", design).priority = 2;
  }
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_THAT(steps[0].added_parts, UnorderedElementsAre("side 2", "shelf 1", "shelf 2"));
  EXPECT_THAT(steps[0].connectors,
              UnorderedElementsAre("shelf 1 screw right", "shelf 2 screw right"));
  EXPECT_EQ(steps[0].priority, 1);
  EXPECT_THAT(steps[1].added_parts, ElementsAre("side 1"));
  EXPECT_EQ(steps[1].priority, 2);
}

TEST(AssemblyPriorities, OfPartsAreFollowed) {
  Design design = ExampleRack();
  Named("side 2", design).priority = 1;
  Named("shelf 2", design).priority = 2;
  Named("shelf 1", design).priority = 3;
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  EXPECT_LE(StepWith(steps, "side 2"), StepWith(steps, "shelf 2"));
  EXPECT_LT(StepWith(steps, "shelf 2"), StepWith(steps, "shelf 1"));
}

TEST(AssemblyPriorities, ThatAreEqualAreOneStep) {
  Design design = ExampleRack();
  for (Part& part : design.parts) part.priority = part.connecting ? 7 : 0;
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(steps[0].added_parts.size(), 4U);
  EXPECT_EQ(steps[0].connectors.size(), 4U);
  EXPECT_EQ(steps[0].priority, 7);
}

// All parts are there with the first priority; the last screw is a step of its own.
TEST(AssemblyPriorities, ThatNoPartComesInWithAreStepsThatOnlyFasten) {
  Design design = ExampleRack();
  for (Part& part : design.parts) part.priority = part.connecting ? 1 : 0;
  Named("shelf 2 screw right", design).priority = 2;
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_THAT(steps[1].added_parts, IsEmpty());
  EXPECT_THAT(steps[1].connectors, ElementsAre("shelf 2 screw right"));
  EXPECT_EQ(steps[1].priority, 2);
  EXPECT_EQ(steps[1].instruction, "Fasten with Wood screw 4 × 40.");
  ASSERT_EQ(steps[1].moves.size(), 1U);  // pictures show what stands
  EXPECT_EQ(steps[1].moves[0].parts.size(), 7U);
}

TEST(AssemblyPriorities, LeaveTheOrderAsItIsWhereThereAreNone) {
  for (const AssemblyStep& step : PrioritizedSteps(ExampleRack()))
    EXPECT_EQ(step.priority, step.number);
}

// A channel, open above and at both ends, and what closes it over a block within.
Design Channel() {
  Design design;
  design.is_drawn = true;
  Part channel = Board("channel", {0, 0, 0}, {0.3, 1, 0.3});
  channel.extrusion_axis = 1;  // outline in (z, x)
  channel.outline = {{0, 0},       {0.3, 0},    {0.3, 0.05}, {0.05, 0.05},
                     {0.05, 0.25}, {0.3, 0.25}, {0.3, 0.3},  {0, 0.3}};
  channel.from = 0;
  channel.to = 1;
  design.parts = {channel, Board("inner", {0.05, 0, 0.05}, {0.25, 1, 0.3}),
                  Board("lid", {0, 0, 0.3}, {0.3, 1, 0.35}),
                  Board("front", {0, -0.05, 0}, {0.3, 0, 0.35}),
                  Board("back", {0, 1, 0}, {0.3, 1.05, 0.35})};
  return design;
}

TEST(AssemblyPriorities, ThatTheShapesContradictAreNamed) {
  Design design = Channel();
  Named("front", design).priority = 1;
  Named("back", design).priority = 1;
  Named("lid", design).priority = 2;
  Named("inner", design).priority = 3;
  EXPECT_EQ(ContradictionIn(design),
            "'inner' (3) cannot come in after 'lid' (2), which closes its way: give 'lid' 3 or "
            "more, or 'inner' 2 or less");
  Named("lid", design).priority = 3;
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  EXPECT_GT(StepWith(steps, "lid"), StepWith(steps, "inner"));
  EXPECT_GT(StepWith(steps, "inner"), StepWith(steps, "front"));
}

TEST(AssemblyPriorities, OfConnectionsThatTheShapesContradictAreNamed) {
  Design design = Channel();
  design.parts.push_back(ScrewPart("lower screw", {0.15, 0.5, 0.02}, 2, 1, 0.08));
  design.parts.push_back(ScrewPart("upper screw", {0.025, 0.5, 0.35}, 2, -1, 0.08));
  for (const std::string end : {"front", "back"}) {
    const double y = end == "front" ? -0.05 : 1.05;
    design.parts.push_back(ScrewPart(end + " screw", {0.15, y, 0.02}, 1, y < 0 ? 1 : -1, 0.1));
    Named(end + " screw", design).priority = 1;
  }
  Named("lower screw", design).priority = 3;
  Named("upper screw", design).priority = 2;
  EXPECT_THAT(ContradictionIn(design), HasSubstr("'inner' (3, by 'lower screw') cannot come in "
                                                 "after 'lid' (2, by 'upper screw')"));
  Named("lower screw", design).priority = 2;
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  EXPECT_GE(StepWith(steps, "lid"), StepWith(steps, "inner"));
}

// Ends with pegs first, then the rails between them: each end comes in as one piece.
TEST(AssemblyPriorities, OrderPiecesByWhatJoinsThem) {
  Design design;
  const double leg = 0.05, length = 1, width = 0.5;
  for (int i = 0; i < 4; ++i) {
    const double x = i % 2 * (length - leg), y = i / 2 * (width - leg);
    design.parts.push_back(Board("leg " + std::to_string(i), {x, y, 0}, {x + leg, y + leg, 0.7}));
  }
  const auto add_peg = [&](const std::string& name, const Eigen::Vector3d& from, int axis,
                           int priority) {
    design.parts.push_back(ScrewPart(name, from, axis, 1, 0.035, 0.008, "items/dowel-8x35"));
    design.parts.back().priority = priority;
  };
  for (int i = 0; i < 2; ++i) {
    const double y = i * (width - leg), x = i * (length - leg);
    const std::string number = std::to_string(i);
    design.parts.push_back(Board("long " + number, {leg, y, 0.6}, {length - leg, y + leg, 0.7}));
    design.parts.push_back(Board("short " + number, {x, leg, 0.6}, {x + leg, width - leg, 0.7}));
    for (int end = 0; end < 2; ++end) {
      const double along_x = end == 0 ? leg : length - leg, along_y = end == 0 ? leg : width - leg;
      const std::string name = "dowel " + number + std::to_string(end);
      add_peg("long " + name, {along_x - 0.0175, y + leg / 2, 0.65}, 0, 2);
      add_peg("short " + name, {x + leg / 2, along_y - 0.0175, 0.65}, 1, 1);
    }
  }
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  int pegs = 0;
  for (const AssemblyStep& step : steps) {
    EXPECT_THAT(step.instruction, Not(HasSubstr("No straight movement"))) << step.number;
    pegs += step.pegs;
  }
  EXPECT_EQ(pegs, 8);
  ASSERT_FALSE(steps.empty());
  EXPECT_EQ(steps.back().priority, 2);
}

TEST(AssemblyPriorities, OfOneConnectionMustBeOne) {
  Design design = ExampleRack();
  design.parts.push_back(ScrewPart("second screw", {0, 0.154, 0.309}, 0, 1));
  Named("shelf 1 screw left", design).priority = 1;
  Named("second screw", design).priority = 2;
  EXPECT_EQ(ContradictionIn(design),
            "'shelf 1 screw left' (1) and 'second screw' (2) touch, so they are one connection: "
            "give them one priority");
  Named("second screw", design).priority = 0;
  EXPECT_GT(StepWith(PrioritizedSteps(design), "second screw"), 0);
}

TEST(AssemblyPriorities, OfPartsMustNotBeLaterThanWhatHoldsThem) {
  Design design = ExampleRack();
  Named("shelf 1", design).priority = 5;
  Named("shelf 1 screw left", design).priority = 4;
  EXPECT_THAT(ContradictionIn(design),
              HasSubstr("'shelf 1' (5) comes in after 'shelf 1 screw left' (4), which holds it"));
}

// A sub-assembly is built by itself, so what is within it comes before what joins it to the rest.
TEST(AssemblyPriorities, WithinSubAssembliesMustNotBeLaterThanWhatJoinsThem) {
  Design design = ExampleRack();
  design.groups.push_back({"box", 0});
  design.parts.push_back(Board("floor", {0.1, 0, 0.318}, {0.3, 0.3, 0.33}));
  design.parts.push_back(Board("wall", {0.1, 0, 0.33}, {0.12, 0.3, 0.5}));
  design.parts.push_back(ScrewPart("box screw", {0.11, 0.1, 0.318}, 2, 1));
  for (std::size_t i = design.parts.size() - 3; i < design.parts.size(); ++i) {
    design.parts[i].group = 1;
  }
  design.parts.push_back(ScrewPart("joint", {0.25, 0.2, 0.3}, 2, 1, 0.025));
  Named("box screw", design).priority = 2;
  Named("joint", design).priority = 1;
  EXPECT_THAT(ContradictionIn(design),
              HasSubstr("'box screw' (2) is within the box, which is built before 'joint' (1)"));
  Named("joint", design).priority = 2;
  const std::vector<AssemblyStep> steps = PrioritizedSteps(design);
  EXPECT_GT(StepWith(steps, "joint"), StepWith(steps, "box screw"));
}

// Whatever the priorities, they are followed or a contradiction is named.
TEST(AssemblyPriorities, AreFollowedOrContradictInRandomPiles) {
  std::mt19937 bits(5);
  int followed = 0, contradictions = 0;
  for (int run = 0; run < 60; ++run) {
    Design design;
    design.is_drawn = true;
    for (int i = 0; i < 18; ++i) {
      const double x = 0.1 * (i % 3), y = 0.1 * (i / 3 % 3), z = 0.1 * (i / 9);
      if (bits() % 4 == 0) continue;
      design.parts.push_back(Board("b" + std::to_string(i), {x, y, z}, {x + 0.1, y + 0.1, z + 0.1},
                                   static_cast<int>(bits() % 4)));
    }
    const auto steps = OrderedSteps(design, ExampleItems(), {});
    if (!steps.ok()) {
      EXPECT_EQ(DetailOf(steps.status()).reason, "PRIORITIES_CONTRADICT") << steps.status();
      ++contradictions;
      continue;
    }
    ++followed;
    int latest = 0;
    std::size_t added = 0;
    for (const AssemblyStep& step : *steps) {
      added += step.added_parts.size();
      int highest = latest;
      for (const std::string& name : step.added_parts) {
        const int priority = Named(name, design).priority;
        EXPECT_TRUE(priority == 0 || priority >= latest) << name << " in run " << run;
        highest = std::max(highest, priority);
      }
      latest = highest;
    }
    EXPECT_EQ(added, design.parts.size());
  }
  EXPECT_GT(followed, 5);
}

}  // namespace
}  // namespace mortise::fabplanner
