#include "services/fabplanner/joining/assembly_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "common/base/errors.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(AssemblySequenceTest, TableGoesTogetherInThreeSteps) {
  const auto steps = AssemblySteps(ExampleTable(), ExampleItems());
  ASSERT_TRUE(steps.ok()) << steps.status();
  ASSERT_EQ(steps->size(), 3);
  EXPECT_THAT((*steps)[0].added_parts,
              ElementsAre("leg_1", "leg_2", "leg_3", "leg_4", "apron_front", "apron_back"));
  EXPECT_EQ((*steps)[0].pegs, 8);
  EXPECT_THAT((*steps)[0].instruction,
              HasSubstr("This makes 2 separate pieces. Push together, each by itself: apron_front, "
                        "leg_1 and leg_2; apron_back, leg_4 and leg_3."));
  EXPECT_THAT((*steps)[1].added_parts, ElementsAre("apron_left", "apron_right"));
  EXPECT_THAT((*steps)[1].instruction, HasSubstr("joins 2 sub-assemblies"));
  EXPECT_THAT((*steps)[2].added_parts, ElementsAre("top"));
  EXPECT_EQ((*steps)[2].number, 3);
  EXPECT_THAT((*steps)[2].instruction, HasSubstr("Put 6 pegs 8 × 35 mm"));
  EXPECT_THAT((*steps)[2].instruction, HasSubstr("3 between top and apron_front"));
  EXPECT_THAT((*steps)[2].instruction, HasSubstr("Push it onto"));
}

TEST(AssemblySequenceTest, EveryPartIsAddedOnceWhateverThePriorities) {
  std::mt19937 random(9);
  for (int trial = 0; trial < 200; ++trial) {
    Design design;
    const int parts = 2 + static_cast<int>(random() % 20);
    for (int i = 0; i < parts; ++i) {
      design.parts.push_back(BoxPart("p" + std::to_string(i), "items/leg-45", CutProcess::kNone,
                                     {0, 0, 0}, {1, 1, 1}, 0, 2));
      if (i == 0) continue;
      const int other = static_cast<int>(random() % i);  // a tree, so it is connected
      design.pegs.push_back(
          MakePeg("c" + std::to_string(i), "p" + std::to_string(i), "p" + std::to_string(other),
                  {0, 0, 0}, Eigen::Vector3d::UnitX(), 0.01, static_cast<int>(random() % 5)));
    }
    const auto steps = AssemblySteps(design, {});
    ASSERT_TRUE(steps.ok()) << steps.status();
    std::map<std::string, int> added;
    std::map<std::string, int> made;
    int last_priority = -1;
    for (const AssemblyStep& step : *steps) {
      EXPECT_GT(step.priority, last_priority);
      last_priority = step.priority;
      for (const std::string& part : step.added_parts) ++added[part];
      for (const StepConnection& connection : step.connections) {
        ++made[connection.name];
        EXPECT_TRUE(added.contains(connection.part) && added.contains(connection.other_part));
      }
    }
    EXPECT_EQ(added.size(), parts);
    EXPECT_EQ(made.size(), parts - 1);
    for (const auto& [part, times] : added) EXPECT_EQ(times, 1) << part;
  }
}

// Copies of a part, each joined to its own neighbour by the same connection, are told once.
TEST(AssemblySequenceTest, CountsCopiesThatAreJoinedAlike) {
  Design design;
  for (const std::string name : {"rail 1", "rail 2", "leg 1", "leg 2", "top"}) {
    design.parts.push_back(
        BoxPart(name, "items/leg-45", CutProcess::kNone, {0, 0, 0}, {1, 1, 1}, 0, 2));
    design.parts.back().title = name.substr(0, name.find(' '));
  }
  for (const char* number : {"1", "2"}) {
    for (int peg = 0; peg < 3; ++peg) {
      design.pegs.push_back(MakePeg("frame", std::string("rail ") + number,
                                    std::string("leg ") + number, {0, 0, 0.1 * peg},
                                    Eigen::Vector3d::UnitX(), 0.01, 1));
    }
    design.pegs.push_back(MakePeg("top", "top", std::string("leg ") + number, {0, 0, 0},
                                  Eigen::Vector3d::UnitZ(), 0.01, 2));
  }
  const auto steps = AssemblySteps(design, {});
  ASSERT_TRUE(steps.ok()) << steps.status();
  ASSERT_EQ(steps->size(), 2);
  EXPECT_EQ((*steps)[0].connections.size(), 2);
  EXPECT_EQ((*steps)[0].pegs, 6);
  EXPECT_THAT((*steps)[0].instruction, HasSubstr("Take 2 × rail and 2 × leg. "));
  EXPECT_THAT((*steps)[0].instruction, HasSubstr("holes: 2 × 3 between rail and leg. "));
  EXPECT_THAT((*steps)[0].instruction, HasSubstr("each by itself: 2 × (rail and leg)."));
  EXPECT_THAT((*steps)[1].instruction, HasSubstr("joins 2 sub-assemblies"));
  design.pegs.back().priority = 3;
  EXPECT_THAT(AssemblySteps(design, {}).status().message(), HasSubstr("differ in priority"));
}

TEST(AssemblySequenceTest, NamesLooseParts) {
  Design design = ExampleTable();
  std::erase_if(design.pegs, [](const Peg& peg) { return peg.part == "top"; });
  const auto steps = AssemblySteps(design, ExampleItems());
  EXPECT_EQ(DetailOf(steps.status()).reason, "PARTS_UNCONNECTED");
  EXPECT_THAT(steps.status().message(), HasSubstr("top"));
}

TEST(AssemblySequenceTest, OnePartAloneIsOneStep) {
  Design design;
  design.parts.push_back(
      BoxPart("board", "items/leg-45", CutProcess::kChopSaw, {0, 0, 0}, {1, 1, 1}, 0, 2));
  const auto steps = AssemblySteps(design, {});
  ASSERT_TRUE(steps.ok()) << steps.status();
  ASSERT_EQ(steps->size(), 1);
  EXPECT_THAT((*steps)[0].added_parts, ElementsAre("board"));
}

TEST(AssemblySequenceTest, RefusesContradictions) {
  Design differing = ExampleTable();
  differing.pegs[0].priority = 7;
  EXPECT_EQ(AssemblySteps(differing, {}).status().code(), absl::StatusCode::kInvalidArgument);
  Design unknown = ExampleTable();
  unknown.pegs[0].other_part = "nowhere";
  EXPECT_THAT(AssemblySteps(unknown, {}).status().message(), HasSubstr("nowhere"));
  Design itself = ExampleTable();
  itself.pegs[0].other_part = itself.pegs[0].part;
  EXPECT_EQ(AssemblySteps(itself, {}).status().code(), absl::StatusCode::kInvalidArgument);
  Design twice = ExampleTable();
  twice.parts[1].name = twice.parts[0].name;
  EXPECT_EQ(DetailOf(AssemblySteps(twice, {}).status()).field, "parts[1].name");
}

}  // namespace
}  // namespace mortise::fabplanner
