// Which parts are near enough to be held together.
#include "services/composer/connecting/linked_parts.h"

#include <gtest/gtest.h>

namespace mortise::composer {
namespace {

PrincipalPart PartIn(const Eigen::Vector3d& minimum, const Eigen::Vector3d& maximum) {
  PrincipalPart part;
  part.box = {minimum, maximum};
  return part;
}

std::vector<LinkedPair> Linked(const PrincipalPart& body, const PrincipalPart& component) {
  return FindLinkedParts({body}, {component}, 0.01, 1e-6);
}

TEST(LinkedPartsTest, WhatLiesAgainstEachOtherIsLinked) {
  const auto linked = Linked(PartIn({0, 0, 0}, {1, 1, 1}), PartIn({1, 0.5, 0}, {2, 2, 1}));
  ASSERT_EQ(linked.size(), 1U);
  EXPECT_EQ(linked[0].apart, 0);
}

TEST(LinkedPartsTest, SoIsWhatHasASmallGapBetween) {
  const auto linked = Linked(PartIn({0, 0, 0}, {1, 1, 1}), PartIn({0, 0, 1.008}, {1, 1, 2}));
  ASSERT_EQ(linked.size(), 1U);
  EXPECT_NEAR(linked[0].apart, 0.008, 1e-12);
  EXPECT_TRUE(Linked(PartIn({0, 0, 0}, {1, 1, 1}), PartIn({0, 0, 1.02}, {1, 1, 2})).empty());
}

TEST(LinkedPartsTest, EdgesAndCornersAreNotEnough) {
  EXPECT_TRUE(Linked(PartIn({0, 0, 0}, {1, 1, 1}), PartIn({1, 1, 0}, {2, 2, 1})).empty());
  EXPECT_TRUE(Linked(PartIn({0, 0, 0}, {1, 1, 1}), PartIn({1.005, 1.005, 0}, {2, 2, 1})).empty());
}

TEST(LinkedPartsTest, TheNearestComeFirst) {
  const std::vector<PrincipalPart> body = {PartIn({0, 0, 0}, {1, 1, 0.994}),
                                           PartIn({0, 0, 2}, {1, 1, 3})};
  const auto linked = FindLinkedParts(body, {PartIn({0, 0, 1}, {1, 1, 2})}, 0.01, 1e-6);
  ASSERT_EQ(linked.size(), 2U);
  EXPECT_EQ(linked[0].body, 1);
  EXPECT_EQ(linked[1].body, 0);
}

}  // namespace
}  // namespace mortise::composer
