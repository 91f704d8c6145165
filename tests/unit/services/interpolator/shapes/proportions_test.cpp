#include "services/interpolator/shapes/proportions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/services/interpolator/shapes/block_designs.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator {
namespace {

BlendedShape BlendOf(const CanonicalMesh& mesh, const std::vector<fields::DesignFields>& designs,
                     bool surface_only) {
  std::vector<PackedShape> packed;
  for (const fields::DesignFields& design : designs) {
    packed.push_back(Pack(Brought(design, mesh).value().shape, mesh).value());
  }
  std::vector<WeightedShape> weighted;
  for (const PackedShape& shape : packed) {
    weighted.push_back({&shape, 1.0 / static_cast<double>(packed.size())});
  }
  BlendedShape blended;
  EXPECT_TRUE(Blend(weighted, mesh, {surface_only, {}}, blended).ok());
  return blended;
}

TEST(Proportions, AreThoseOfABoxBetweenBoxes) {
  const BlockCells cells{.along = 4, .across = 3, .high = 3};
  const std::vector<fields::DesignFields> boxes = {BlockDesign(BoxShape({2, 1, 0.5}), cells),
                                                   BlockDesign(BoxShape({4, 1.4, 0.7}), cells)};
  const CanonicalMesh mesh = CanonicalMesh::Create(boxes[0]).value();
  for (const bool surface_only : {true, false}) {
    const Proportions box = ProportionsOf(BlendOf(mesh, boxes, surface_only), mesh);
    EXPECT_TRUE(box.has_volume);
    EXPECT_NEAR(box.volume, 3 * 1.2 * 0.6, 1e-5);
    EXPECT_NEAR(box.surface_area, 2 * (3 * 1.2 + 1.2 * 0.6 + 0.6 * 3), 1e-4);
    EXPECT_LT((box.centroid - Eigen::Vector3d(1.5, 0.6, 0.3)).norm(), 1e-5);
  }
}

TEST(Proportions, AreThoseOfACylinder) {
  const BlockCells cells{.along = 40, .across = 40, .high = 2};
  const fields::DesignFields cylinder = BlockDesign(CylinderShape(0.1, 0.3), cells);
  const CanonicalMesh mesh = CanonicalMesh::Create(SurfaceOnly(cylinder)).value();
  const Proportions round = ProportionsOf(BlendOf(mesh, {SurfaceOnly(cylinder)}, true), mesh);
  EXPECT_NEAR(round.volume, M_PI * 0.01 * 0.3, 1e-3 * round.volume);
  EXPECT_NEAR(round.surface_area, 2 * M_PI * 0.1 * (0.1 + 0.3), 1e-3 * round.surface_area);
  EXPECT_LT((round.centroid - Eigen::Vector3d(0, 0, 0.15)).norm(), 1e-6);
}

TEST(Proportions, HaveNoVolumeWhereTheSurfaceIsOpen) {
  fields::DesignFields design = SurfaceOnly(BlockDesign(BoxShape({2, 1, 0.5}), {}));
  const Eigen::Index left = design.triangles.cols() - 1;
  design.triangles = design.triangles.leftCols(left).eval();
  design.triangle_back = design.triangle_back.head(left).eval();
  design.triangle_front = design.triangle_front.head(left).eval();
  design.regions.clear();
  const CanonicalMesh mesh = CanonicalMesh::Create(design).value();
  const Proportions open = ProportionsOf(BlendOf(mesh, {design}, true), mesh);
  EXPECT_FALSE(open.has_volume);
  EXPECT_EQ(open.volume, 0);
  EXPECT_GT(open.surface_area, 6);
}

}  // namespace
}  // namespace mortise::interpolator
