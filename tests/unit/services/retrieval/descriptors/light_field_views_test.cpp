#include "services/retrieval/descriptors/light_field_views.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace mortise::retrieval {
namespace {

Eigen::Vector3d Direction(const View& view) { return view.right.cross(view.up); }

TEST(LightFieldViewsTest, LookFromTheVerticesOfTwoDodecahedra) {
  const std::vector<View> views = LightFieldViews();
  ASSERT_EQ(views.size(), 16U);
  // Neighbouring vertices of a regular dodecahedron are seen under an angle of cosine √5/3, and
  // each has three, of its own dodecahedron, opposite vertices counting as one.
  for (const View& view : views) {
    EXPECT_NEAR(view.right.dot(view.up), 0, 1e-12);
    EXPECT_NEAR(view.right.norm(), 1, 1e-12);
    EXPECT_NEAR(view.up.norm(), 1, 1e-12);
    int neighbours = 0;
    for (const View& other : views) {
      const double cosine = std::abs(Direction(view).dot(Direction(other)));
      neighbours += std::abs(cosine - std::sqrt(5) / 3) < 1e-9;
      EXPECT_TRUE(&view == &other || cosine < 0.999);
    }
    EXPECT_GE(neighbours, view.weight > 0.3 ? 6 : 3);
  }
}

TEST(LightFieldViewsTest, GiveTheMeanOfTheirSquares) {
  double squares = 0;
  for (const View& view : LightFieldViews()) squares += view.weight * view.weight;
  EXPECT_NEAR(squares, 1, 1e-12);
}

TEST(LightFieldViewsTest, AreTurnedIntoEachOther) {
  const std::vector<View> views = LightFieldViews();
  const std::vector<EarlierView> before = ViewsBeforeQuarterTurn();
  ASSERT_EQ(before.size(), views.size());
  const auto turned = [](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(-v.y(), v.x(), v.z());
  };
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& earlier = views[static_cast<std::size_t>(before[i].view)];
    const double sign = before[i].mirrored ? -1 : 1;
    EXPECT_TRUE(turned(earlier.right).isApprox(sign * views[i].right, 1e-12)) << i;
    EXPECT_TRUE(turned(earlier.up).isApprox(views[i].up, 1e-12)) << i;
    EXPECT_EQ(earlier.slant, views[i].slant);
    EXPECT_EQ(earlier.weight, views[i].weight);
  }
}

TEST(LightFieldViewsTest, StandUprightAndScanNoAxisAlongARow) {
  for (const View& view : LightFieldViews()) {
    EXPECT_EQ(view.right.z(), 0);
    EXPECT_GT(view.up.z(), 0);
    const Eigen::Vector3d across =
        std::cos(view.slant) * view.up + std::sin(view.slant) * view.right;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(std::abs(across[axis]), 0.1 * std::hypot(view.right[axis], view.up[axis]));
    }
  }
}

}  // namespace
}  // namespace mortise::retrieval
