// The planes by which components are aligned.
#include "services/composer/snapping/plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

const DesignPlane* Find(const std::vector<DesignPlane>& planes, const std::string& described) {
  const auto found = std::find_if(planes.begin(), planes.end(), [&](const DesignPlane& plane) {
    return Describe(plane) == described;
  });
  return found == planes.end() ? nullptr : &*found;
}

TEST(PlaneTest, EveryPartHasItsFacesWhereTheyAreNow) {
  const Design moved = DroppedAt(ShippedDesign("cabinet"), {1, 2, 3});
  const std::vector<PrincipalPart> parts = PrincipalPartsOf(moved);
  const std::vector<DesignPlane> planes = PlanesOf(moved, parts);
  ASSERT_GE(planes.size(), 6 * parts.size());
  for (const DesignPlane& plane : planes) {
    EXPECT_NEAR(plane.position.At(InSpace(moved)), plane.now, 1e-9) << Describe(plane);
    if (plane.part < 0) continue;
    const PrincipalPart& part = parts[static_cast<std::size_t>(plane.part)];
    const int axis = static_cast<int>(plane.axis);
    const double place =
        plane.side == PlaneSide::kMinimum ? part.box.minimum[axis] : part.box.maximum[axis];
    EXPECT_EQ(plane.now, place) << Describe(plane);
  }
}

TEST(PlaneTest, BoardsHaveTwoBroadFaces) {
  const Design& design = ShippedDesign("bookshelf");
  const std::vector<DesignPlane> planes = PlanesOf(design, PrincipalPartsOf(design));
  EXPECT_TRUE(Find(planes, "'side 1' x maximum")->is_broad);
  EXPECT_FALSE(Find(planes, "'side 1' y maximum")->is_broad);
  EXPECT_TRUE(Find(planes, "'shelf 3' z minimum")->is_broad);
}

TEST(PlaneTest, ProminentPlanesHaveNoSide) {
  const Design& design = ShippedDesign("cabinet");
  const std::vector<DesignPlane> planes = PlanesOf(design, PrincipalPartsOf(design));
  const DesignPlane* const fronts = Find(planes, "'top' left fronts");
  ASSERT_NE(fronts, nullptr);
  EXPECT_EQ(fronts->side, PlaneSide::kNone);
  EXPECT_NEAR(fronts->now, 0.4985, 1e-12);
}

// The lid of the chest stands upright behind it.
TEST(PlaneTest, WhatMovesHasPlanesInItsRestPoses) {
  const Design& design = ShippedDesign("toy_chest");
  const std::vector<DesignPlane> planes = PlanesOf(design, PrincipalPartsOf(design));
  const auto in_pose = std::count_if(planes.begin(), planes.end(), [](const DesignPlane& plane) {
    return plane.part < 0 && plane.side != PlaneSide::kNone;
  });
  EXPECT_EQ(in_pose, 2 * 6);  // two poses, the lid's six faces each
  for (const DesignPlane& plane : planes) {
    if (plane.part < 0) {
      EXPECT_EQ(plane.owner, "lid board");
    }
  }
}

}  // namespace
}  // namespace mortise::composer
