// Structures: equal where all counts are, told apart by their keys, and said in words.
#include "common/design/structure.h"

#include <gtest/gtest.h>

#include <set>

namespace mortise::parametric {
namespace {

TEST(StructureTest, TheSameCountsAreTheSameStructure) {
  const Structure shelf{{{"shelf 1", {6}}, {"screw 1", {2, 6}}}};
  EXPECT_EQ(shelf, (Structure{{{"shelf 1", {6}}, {"screw 1", {2, 6}}}}));
  EXPECT_EQ(KeyOf(shelf), KeyOf(Structure{{{"shelf 1", {6}}, {"screw 1", {2, 6}}}}));
}

// Others keep keys in records: they are the same with every release.
TEST(StructureTest, KeysAreTheSameOnAnyMachine) {
  // printf 'structure\n7 shelf 1 6\n7 screw 1 2 6' | sha256sum
  EXPECT_EQ(KeyOf({{{"shelf 1", {6}}, {"screw 1", {2, 6}}}}),
            "e234b8e40c916c55204961265c21ef070c02579826b9c532f125a3755ebfb664");
}

TEST(StructureTest, WhateverDiffersHasAnotherKey) {
  const std::vector<Structure> all = {
      {},
      {{{"a", {6}}}},
      {{{"a", {7}}}},
      {{{"b", {6}}}},
      {{{"a", {6, 1}}}},
      {{{"a", {61}}}},
      {{{"a 6", {1}}}},
      {{{"a", {6}}, {"b", {6}}}},
      {{{"b", {6}}, {"a", {6}}}},
      {{{"a 6\n1 b", {6}}}},
  };
  std::set<std::string> keys;
  for (const Structure& structure : all) keys.insert(KeyOf(structure));
  EXPECT_EQ(keys.size(), all.size());
}

TEST(StructureTest, IsSaidInWords) {
  EXPECT_EQ(Describe({{{"slats", {7}}}}), "slats: 7");
  EXPECT_EQ(Describe({{{"slats", {7}}, {"screws", {2, 7}}}}), "slats: 7, screws: 2 × 7");
  EXPECT_EQ(Describe({}), "always the same");
}

}  // namespace
}  // namespace mortise::parametric
