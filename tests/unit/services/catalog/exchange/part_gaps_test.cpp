// Gaps are closed, and what was alike stays so.
#include "services/catalog/exchange/part_gaps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace mortise::catalog {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kContact = 0.004;

AlignedBox3d BoxAt(const Vector3d& low, const Vector3d& size) { return {low, low + size}; }

// How far two boxes are apart.
double Gap(const AlignedBox3d& a, const AlignedBox3d& b) { return a.exteriorDistance(b); }

void ExpectOneSize(const std::vector<AlignedBox3d>& boxes, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    EXPECT_TRUE(boxes[i].sizes().isApprox(boxes[begin].sizes(), 1e-12)) << i;
  }
}

TEST(CloseGaps, StretchesTheSmallerOfTwo) {
  const AlignedBox3d top = BoxAt({0, 0, 0.7}, {1, 1, 0.02});
  std::vector<AlignedBox3d> boxes = {top, BoxAt({0, 0, 0}, {0.05, 0.05, 0.699})};
  CloseGaps(kContact, {0, 1}, boxes);
  EXPECT_TRUE(boxes[0].isApprox(top));
  EXPECT_NEAR(boxes[1].max().z(), 0.7, 1e-15);
  EXPECT_EQ(boxes[1].min(), Vector3d(0, 0, 0));
}

TEST(CloseGaps, LeavesWhatIsFurtherApart) {
  const std::vector<AlignedBox3d> drawn = {BoxAt({0, 0, 0}, {1, 1, 1}),
                                           BoxAt({0, 0, 1.005}, {1, 1, 0.5})};
  std::vector<AlignedBox3d> boxes = drawn;
  CloseGaps(kContact, {0, 1}, boxes);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(boxes[i].isApprox(drawn[i]));
}

// Planks a millimetre apart: of each two neighbours one is stretched, and the first has none.
TEST(CloseGaps, KeepsPlanksAlikeThatNearlyTouchEachOther) {
  std::vector<AlignedBox3d> boxes;
  std::vector<int> first_alike;
  for (int plank = 0; plank < 7; ++plank) {
    boxes.push_back(BoxAt({0.101 * plank, 0, 0}, {0.1, 2, 0.02}));
    first_alike.push_back(0);
  }
  CloseGaps(kContact, first_alike, boxes);
  ExpectOneSize(boxes, 0, 7);
  for (std::size_t plank = 1; plank < 7; ++plank) {
    EXPECT_LE(Gap(boxes[plank - 1], boxes[plank]), 1e-12);
    EXPECT_NEAR((boxes[plank].center() - boxes[plank - 1].center()).x(), 0.101, 1e-12);
  }
}

// Slats between two posts, of which only the first and the last come near one.
TEST(CloseGaps, StretchesWhatFewAreLikeWhereNotAllSlatsNeedIt) {
  std::vector<AlignedBox3d> boxes = {BoxAt({-0.101, 0, 0}, {0.1, 0.1, 1}),
                                     BoxAt({0.901, 0, 0}, {0.1, 0.1, 1})};
  std::vector<int> first_alike = {0, 0};
  for (int slat = 0; slat < 5; ++slat) {
    boxes.push_back(BoxAt({0.2 * slat, 0, 0}, {0.1, 0.02, 0.8}));
    first_alike.push_back(2);
  }
  const std::vector<AlignedBox3d> drawn = boxes;
  CloseGaps(kContact, first_alike, boxes);
  ExpectOneSize(boxes, 0, 2);
  ExpectOneSize(boxes, 2, 7);
  for (std::size_t slat = 2; slat < 7; ++slat) EXPECT_TRUE(boxes[slat].isApprox(drawn[slat]));
  EXPECT_LE(Gap(boxes[0], boxes[2]), 1e-12);
  EXPECT_LE(Gap(boxes[1], boxes[6]), 1e-12);
}

// Legs that all stand off the top are stretched, as they are smaller: the top stays as thick as it
// is.
TEST(CloseGaps, StretchesAllThatNeedTheSame) {
  std::vector<AlignedBox3d> boxes = {BoxAt({0, 0, 0.7}, {1, 1, 0.02})};
  std::vector<int> first_alike = {0};
  for (int leg = 0; leg < 4; ++leg) {
    boxes.push_back(BoxAt({0.9 * (leg % 2), 0.9 * (leg / 2), 0}, {0.05, 0.05, 0.6995}));
    first_alike.push_back(1);
  }
  const AlignedBox3d top = boxes[0];
  CloseGaps(kContact, first_alike, boxes);
  EXPECT_TRUE(boxes[0].isApprox(top));
  ExpectOneSize(boxes, 1, 5);
  for (std::size_t leg = 1; leg < 5; ++leg) EXPECT_NEAR(boxes[leg].max().z(), 0.7, 1e-12);
}

// One leg that is too low: the others go on touching, and all four are one leg.
TEST(CloseGaps, KeepsLegsAlikeOfWhichOneStandsLower) {
  std::vector<AlignedBox3d> boxes = {BoxAt({0, 0, 0.7}, {1, 1, 0.02})};
  std::vector<int> first_alike = {0};
  for (int leg = 0; leg < 4; ++leg) {
    boxes.push_back(
        BoxAt({0.9 * (leg % 2), 0.9 * (leg / 2), leg == 3 ? -0.001 : 0}, {0.05, 0.05, 0.7}));
    first_alike.push_back(1);
  }
  CloseGaps(kContact, first_alike, boxes);
  ExpectOneSize(boxes, 1, 5);
  for (std::size_t leg = 1; leg < 5; ++leg) EXPECT_LE(Gap(boxes[0], boxes[leg]), 1e-12);
}

}  // namespace
}  // namespace mortise::catalog
