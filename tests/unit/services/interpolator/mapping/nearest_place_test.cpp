#include "services/interpolator/mapping/nearest_place.h"

#include <gtest/gtest.h>

#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

TEST(NearestPlacesTest, FindsPlacesOnABox) {
  const mesh::SurfaceMesh box = MakeBlockMesh(BoxShape({1, 2, 3}), {}).marked.surface;
  const NearestPlaces nearest(box);
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.4, 1.3, 4), Eigen::Vector3d(-1, 5, 0.7),
                                       Eigen::Vector3d(0.5, 1, 0.1), Eigen::Vector3d(2, 3, 4)}) {
    Eigen::Vector3d known = point.cwiseMax(0).cwiseMin(Eigen::Vector3d(1, 2, 3));
    if (known == point) known.z() = 0;
    const TrianglePlace place = nearest.Find(point);
    const Eigen::Vector3d found =
        box.vertices(Eigen::all, box.triangles.col(place.triangle)) * place.barycentric;
    EXPECT_LT((found - known).norm(), 1e-12);
    EXPECT_NEAR(nearest.Distance(point), (known - point).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace mortise::interpolator
