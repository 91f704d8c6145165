// What touches one part of a row stays on one, however the row is laid out anew; and rows stay rows
// where that is so anyway.
#include "common/assembly/trial/pattern_losses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/assembly/model/pattern_contact.h"
#include "common/assembly/parametric_assembly.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/expect_sound.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

// Six slats across two rails, 0.3 m apart; as wide as their item comes, or resizable.
Assembly Slats(bool fixed) {
  Assembly slats = Named("slats", {ResizablePart("left rail", {0, 0, 0}, {0.04, 2, 0.1}),
                                   ResizablePart("right rail", {0.96, 0, 0}, {1, 2, 0.1})});
  for (int i = 0; i < 6; ++i) {
    const double at = 0.1 + 0.3 * i;
    AssemblyPart slat =
        ResizablePart("slat " + std::to_string(i), {0, at, 0.1}, {1, at + 0.1, 0.12});
    slat.item = "items/slat";
    if (fixed) slat.limits[1] = {0.1, 0.1};
    slats.parts.push_back(slat);
  }
  return slats;
}

AssemblyPart Screw(const std::string& name, double x, double y) {
  AssemblyPart screw = FixedPart(name, {x, y, 0.07}, {x + 0.004, y + 0.004, 0.12});
  screw.item = "items/screw";
  screw.connecting = true;
  return screw;
}

// How many parts the largest row of slats has.
std::size_t LongestRow(const ParametricAssembly& assembly) {
  std::size_t longest = 0;
  for (const Element& element : assembly.elements()) {
    if (element.item == "items/slat") longest = std::max(longest, element.parts.size());
  }
  return longest;
}

class PatternLosses : public ::testing::TestWithParam<bool> {
 protected:
  // Sound in all designs, and how long the longest row of slats still is.
  void Expect(const Assembly& assembly, std::size_t longest_row) {
    ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(assembly));
    EXPECT_EQ(LongestRow(made), longest_row);
    ExpectSound(made);
  }

  Assembly slats_ = Slats(GetParam());
};

TEST_P(PatternLosses, AScrewInOneSlatEndsTheRowThere) {
  slats_.parts.push_back(Screw("screw", 0.01, 0.445));
  Expect(slats_, 4);
}

// Slats that keep their width hold the screws with their inner faces; of others the row ends.
TEST_P(PatternLosses, ScrewsInTheOuterSlatsStayInThem) {
  slats_.parts.push_back(Screw("first screw", 0.01, 0.145));
  slats_.parts.push_back(Screw("last screw", 0.01, 1.645));
  Expect(slats_, GetParam() ? 6 : 4);
}

TEST_P(PatternLosses, ScrewsInEveryOtherSlatTakeTheRowApart) {
  for (int i = 0; i < 3; ++i) {
    slats_.parts.push_back(Screw("screw " + std::to_string(i), 0.01, 0.145 + 0.6 * i));
  }
  Expect(slats_, 1);
}

// It touches the rail alone, but a slat would run into it.
TEST_P(PatternLosses, AScrewBetweenTwoSlatsEndsTheRowThere) {
  slats_.parts.push_back(Screw("screw", 0.01, 0.345));
  Expect(slats_, 5);
}

TEST_P(PatternLosses, AScrewInEachSlatKeepsTheRow) {
  for (int i = 0; i < 6; ++i) {
    slats_.parts.push_back(Screw("screw " + std::to_string(i), 0.01, 0.145 + 0.3 * i));
  }
  Expect(slats_, 6);
}

TEST_P(PatternLosses, WhatStandsOnASlatEndsTheRowThere) {
  slats_.parts.push_back(ResizablePart("box", {0.4, 0.41, 0.12}, {0.45, 0.49, 0.2}));
  Expect(slats_, 4);
}

TEST_P(PatternLosses, ABattenAcrossSeveralKeepsTheRow) {
  slats_.parts.push_back(ResizablePart("batten", {0.4, 0.1, 0.12}, {0.45, 0.8, 0.14}));
  Expect(slats_, 6);
}

// A cleat that begins where the row begins lies under the first slat always.
TEST_P(PatternLosses, WhatIsInOnePlaneWithTheEndKeepsTheRow) {
  slats_.parts.push_back(FixedPart("cleat", {0.04, 0.1, 0.06}, {0.1, 0.13, 0.1}));
  Expect(slats_, 6);
}

INSTANTIATE_TEST_SUITE_P(Widths, PatternLosses, ::testing::Bool(), [](const auto& width) {
  return width.param ? std::string("Fixed") : std::string("Resizable");
});

TEST(PartialContacts, AreThoseWithSomePartsOnly) {
  const Assembly slats = Slats(true);
  std::vector<int> row = {2, 3, 4, 5, 6, 7};
  PatternDirection along{6, {0, 0.3, 0}};
  const auto found = [&](const AssemblyPart& part) {
    Assembly with = slats;
    with.parts.push_back(part);
    return FindPartialContacts(with, {along, PatternDirection{}}, row, 1e-6);
  };
  ASSERT_THAT(found(Screw("screw", 0.01, 0.445)), SizeIs(1));
  EXPECT_EQ(found(Screw("screw", 0.01, 0.445))[0].part, 8);
  EXPECT_FALSE(found(Screw("screw", 0.01, 0.445))[0].stands_between);
  ASSERT_THAT(found(Screw("in a gap", 0.5, 0.35)), SizeIs(1));
  EXPECT_TRUE(found(Screw("in a gap", 0.5, 0.35))[0].stands_between);
  EXPECT_THAT(found(FixedPart("at the end", {0, 0.05, 0.1}, {1, 0.1, 0.12})), IsEmpty());
  EXPECT_THAT(found(FixedPart("batten", {0.4, 0.1, 0.12}, {0.45, 0.8, 0.14})), IsEmpty());
}

// A grid of screws, one in each slat on each of three rails, and legs under the first slat and the
// last: the screws fall back to a row on each rail, and nobody loses all patterns.
TEST(PatternLossesTest, AGridFallsBackToRows) {
  Assembly bench = Named("bench", {});
  for (int i = 0; i < 6; ++i) {
    const double y = 0.124 * i;
    AssemblyPart slat =
        FixedPart("slat " + std::to_string(i), {0, y, 0.4}, {1.2, y + 0.064, 0.419});
    slat.item = "items/slat";
    slat.limits[0] = {0.1, 2.4};
    bench.parts.push_back(slat);
  }
  for (int j = 0; j < 3; ++j) {
    const double x = 0.581 * j;
    AssemblyPart rail =
        FixedPart("rail " + std::to_string(j), {x, 0, 0.311}, {x + 0.038, 0.684, 0.4});
    rail.item = "items/rail";
    rail.limits[1] = {0.1, 2.4};
    bench.parts.push_back(rail);
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d at(x + 0.017, 0.03 + 0.124 * i, 0.369);
      AssemblyPart screw = FixedPart("screw " + std::to_string(j) + "." + std::to_string(i), at,
                                     at + Eigen::Vector3d(0.004, 0.004, 0.05));
      screw.item = "items/screw";
      screw.connecting = true;
      bench.parts.push_back(screw);
    }
  }
  for (const double x : {0.038, 1.124}) {
    for (const double y : {0.0, 0.62}) {
      AssemblyPart leg = FixedPart("leg", {x, y, 0}, {x + 0.038, y + 0.064, 0.4});
      leg.item = "items/leg";
      leg.name += std::to_string(bench.parts.size());
      leg.limits[2] = {0.1, 2.4};
      bench.parts.push_back(leg);
    }
  }
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(bench));
  EXPECT_EQ(LongestRow(made), 6U);
  const auto& elements = made.elements();
  const auto has_pattern = [](const Element& element) { return element.pattern.has_value(); };
  EXPECT_GE(std::count_if(elements.begin(), elements.end(), has_pattern), 4);
  ExpectSound(made);
}

// Boards on both sides of a rail, the rear ones before the gaps of the front ones: nails from both
// sides pass each other as long as neither row is spread anew.
TEST(PatternLossesTest, NailsFromTwoSidesDoNotMeet) {
  Assembly fence = Named("fence", {FixedPart("rail", {0, 0, 0.2}, {1.2, 0.038, 0.289})});
  fence.parts[0].limits[0] = {0.1, 2.4};
  for (int i = 0; i < 4; ++i) {
    for (const bool front : {true, false}) {
      const double x = 0.15 * i + (front ? 0 : 0.075), y = front ? -0.019 : 0.038;
      AssemblyPart board = FixedPart((front ? "front " : "rear ") + std::to_string(i), {x, y, 0.05},
                                     {x + 0.089, y + 0.019, 0.75});
      board.item = "items/slat";
      board.limits[2] = {0.1, 2.4};
      const double depth = front ? -0.019 : 0.007;
      AssemblyPart nail = FixedPart((front ? "front nail " : "rear nail ") + std::to_string(i),
                                    {x + 0.043, depth, 0.243}, {x + 0.046, depth + 0.05, 0.246});
      nail.item = "items/nail";
      nail.connecting = true;
      fence.parts.push_back(board);
      fence.parts.push_back(nail);
    }
  }
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(fence));
  ExpectSound(made);
}

}  // namespace
}  // namespace mortise::parametric
