#include "services/retrieval/descriptors/canonical_surface.h"

#include <gtest/gtest.h>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

// Faults of the input are tested with the descriptors (descriptor_test.cpp).

TEST(CanonicalSurfaceTest, KeepsEachTriangleWithAreaOnce) {
  const mesh::SurfaceMesh chair = Chair();
  const auto whole = MakeCanonical(Joined({chair, chair}));
  ASSERT_TRUE(testing::IsOk(whole));
  EXPECT_EQ(whole->triangles.cols(), chair.triangles.cols());
  EXPECT_EQ(whole->vertices, 2 * chair.vertices.cols());
}

TEST(CanonicalSurfaceTest, PutsTheBoxAroundTheTrianglesToItsUnit) {
  const mesh::SurfaceMesh box = Box({1, 2, 3}, {2, 4, 11});
  const auto canonical = MakeCanonical(box);
  ASSERT_TRUE(testing::IsOk(canonical));
  const auto placed = ToReferenceBox(*canonical, box.vertices);
  ASSERT_TRUE(testing::IsOk(placed));
  EXPECT_TRUE(placed->rowwise().maxCoeff().isApprox(Eigen::Vector3d(0.125, 0.25, 1)));
  EXPECT_TRUE(placed->rowwise().minCoeff().isApprox(Eigen::Vector3d(-0.125, -0.25, -1)));
  const auto speeds = VelocitiesInReferenceBox(*canonical, box.vertices, 0);
  ASSERT_TRUE(testing::IsOk(speeds));
  EXPECT_TRUE(speeds->isApprox(box.vertices / 4));
}

TEST(CanonicalSurfaceTest, OrdersTrianglesByPlace) {
  // Along Morton's curve the eight octants of a cloud of small boxes come one after the other.
  std::vector<mesh::SurfaceMesh> boxes;
  for (int i = 0; i < 64; ++i) {
    const Eigen::Vector3d corner(i % 4, i / 4 % 4, i / 16);
    boxes.push_back(Box(corner, corner.array() + 0.5));
  }
  const mesh::SurfaceMesh cloud = Joined(boxes);
  const auto canonical = MakeCanonical(cloud);
  ASSERT_TRUE(testing::IsOk(canonical));
  const auto octant = [&](Eigen::Index t) {
    const Eigen::Vector3d middle =
        cloud.vertices(Eigen::all, canonical->triangles.col(t)).rowwise().mean();
    return int(middle.x() > 1.75) + 2 * int(middle.y() > 1.75) + 4 * int(middle.z() > 1.75);
  };
  for (Eigen::Index t = 1; t < canonical->triangles.cols(); ++t) {
    EXPECT_LE(octant(t - 1), octant(t));
  }
}

}  // namespace
}  // namespace mortise::retrieval
