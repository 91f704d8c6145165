// What only trying shows is mended, and nothing else is touched.
#include "common/assembly/trial/design_trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/parametric_assembly.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/expect_sound.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

bool NobodyLeaves() { return false; }

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Pegs of any size on a board, the upper row across its edge or below it.
Assembly PegBoard(double highest) {
  Assembly pegs = Named("pegs", {ResizablePart("board", {0, 0, 0}, {1.2, 0.02, 0.7})});
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double x = 0.2 + 0.2 * j;
      const double z = highest - 0.15 * (3 - i);
      AssemblyPart peg =
          ResizablePart(absl::StrCat("peg ", i, ".", j), {x, -0.09, z}, {x + 0.02, 0, z + 0.02});
      peg.item = "items/peg";
      pegs.parts.push_back(peg);
    }
  }
  return pegs;
}

std::size_t LargestPattern(const ParametricAssembly& assembly) {
  std::size_t largest = 0;
  for (const Element& element : assembly.elements()) {
    if (element.pattern) largest = std::max(largest, element.parts.size());
  }
  return largest;
}

TEST(DesignTrial, AGridOnABoardStaysAPattern) {
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(PegBoard(0.6)));
  EXPECT_EQ(LargestPattern(made), 16U);
  ExpectSound(made);
}

TEST(DesignTrial, AGridAcrossTheEdgeOfItsBoardDoesNotLeaveIt) {
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(PegBoard(0.69)));
  ExpectSound(made);
}

// A lid leans back over a box behind the chest, at an angle that leaves it no planes along the
// axes.
Assembly ChestBeforeABox(double angle) {
  Assembly chest = Named("chest", {ResizablePart("chest", {0, 0, 0}, {0.8, 0.5, 0.4}),
                                   ResizablePart("floor", {0, 0, -0.02}, {0.8, 1, 0}),
                                   ResizablePart("box", {0, 0.7, 0}, {0.8, 0.9, 0.25}),
                                   ResizablePart("lid", {0, 0, 0.4}, {0.8, 0.5, 0.42}, 1)});
  chest.groups.push_back({"lid", 0});
  Joint hinge;
  hinge.name = "hinge";
  hinge.group = 1;
  hinge.center = {0.4, 0.5, 0.4};
  hinge.axis = -Eigen::Vector3d::UnitX();
  hinge.upper = 3;
  hinge.rest_poses = {{"open", angle * hinge.axis}};
  chest.joints = {hinge};
  return chest;
}

TEST(DesignTrial, ALidThatLeansStaysClearOfWhatItLeansOver) {
  const Assembly chest = ChestBeforeABox(2.2);
  ASSERT_THAT(ValidateAssembly(chest), IsEmpty());
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(chest));
  std::vector<std::string> descriptions;
  for (const Relationship& one : made.relationships()) descriptions.push_back(one.description);
  EXPECT_THAT(descriptions, Contains("'box' clear of 'lid' in 'hinge: open'"));
  ExpectSound(made);
}

// An arm that comes to rest on the edge of a stop, at an angle that leaves it no planes along the
// axes.
Assembly ArmOnAStop(double angle) {
  const double length = 0.5, thick = 0.03;
  // The lower face of the arm, 0.4 m from its hinge.
  const Eigen::Vector3d hinge(0, 0.05, 0.6), along(std::cos(angle), 0, -std::sin(angle));
  const Eigen::Vector3d edge = hinge + 0.4 * along;
  Assembly stop =
      Named("arm", {ResizablePart("post", {-0.04, 0, 0}, {0, 0.1, 0.7}),
                    ResizablePart("floor", {-0.04, 0, -0.02}, {0.8, 0.1, 0}),
                    ResizablePart("stop", {edge.x() - 0.05, 0, 0}, {edge.x(), 0.1, edge.z()}),
                    ResizablePart("arm", {0, 0, 0.6}, {length, 0.1, 0.6 + thick}, 1)});
  stop.groups.push_back({"swinging", 0});
  Joint joint;
  joint.name = "hinge";
  joint.group = 1;
  joint.center = hinge;
  joint.axis = Eigen::Vector3d::UnitY();
  joint.upper = 1.5;
  joint.rest_poses = {{"down", angle * joint.axis}};
  stop.joints = {joint};
  return stop;
}

TEST(DesignTrial, AnArmStaysOnTheStopThatItLeansOn) {
  for (const double angle : {0.3, 0.5, 0.8}) {
    SCOPED_TRACE(angle);
    const Assembly arm = ArmOnAStop(angle);
    ASSERT_THAT(ValidateAssembly(arm), IsEmpty());
    ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(arm));
    std::vector<std::string> descriptions;
    for (const Relationship& one : made.relationships()) descriptions.push_back(one.description);
    EXPECT_THAT(descriptions, Contains("'stop' on 'arm' in 'hinge: down'"));
    ExpectSound(made);
  }
}

// Asked between designs, so that what nobody waits for takes no more than a moment.
TEST(DesignTrial, IsGivenUpWhenNobodyWaits) {
  const Assembly pegs = PegBoard(0.69);
  EXPECT_EQ(ParametricAssembly::Create(pegs, [] { return true; }).status().code(),
            absl::StatusCode::kCancelled);
  int asked = 0;
  EXPECT_EQ(ParametricAssembly::Create(pegs, [&asked] { return ++asked == 10; }).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(asked, 10);
}

TEST(DesignTrial, SaysNothingOfWhatHasNeitherPatternsNorPoses) {
  ASSERT_OK_AND_ASSIGN(const auto table, ParametricAssembly::Create(TwoLeggedTable()));
  ASSERT_OK_AND_ASSIGN(const RepairPlan repair_plan,
                       TryDesigns(table.assembly(), table.elements(), table.feasible_set(), {},
                                  table.tolerance(), NobodyLeaves));
  EXPECT_THAT(repair_plan.lone, IsEmpty());
  EXPECT_THAT(repair_plan.known_conflicts.kept_apart, IsEmpty());
}

// Without them designs are at fault, and what is found is the same each time.
TEST(DesignTrial, NamesWhatIsAtFaultTheSameEachTime) {
  const Assembly pegs = PegBoard(0.69);
  const double tolerance = 1e-6;
  const std::vector<Element> elements = MakeElements(pegs, tolerance);
  std::vector<Relationship> relationships =
      FindRelationships(pegs, elements, TouchingPairs(elements), tolerance);
  const auto board = std::find_if(elements.begin(), elements.end(),
                                  [](const Element& element) { return !element.pattern; });
  for (Relationship& held : Anchor(elements, static_cast<int>(board - elements.begin()))) {
    relationships.push_back(std::move(held));
  }
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set,
                       FeasibleSet::Create(relationships, DrawnParameters(pegs, elements),
                                           VariablesWithin(pegs, elements, 0)));
  ASSERT_OK_AND_ASSIGN(const RepairPlan first,
                       TryDesigns(pegs, elements, set, {}, tolerance, NobodyLeaves));
  ASSERT_OK_AND_ASSIGN(const RepairPlan again,
                       TryDesigns(pegs, elements, set, {}, tolerance, NobodyLeaves));
  EXPECT_EQ(first.lone.size(), 16U);
  EXPECT_EQ(first.lone, again.lone);
}

}  // namespace
}  // namespace mortise::parametric
