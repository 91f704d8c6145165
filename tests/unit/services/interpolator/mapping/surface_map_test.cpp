#include "services/interpolator/mapping/surface_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

struct Case {
  std::string name;
  BlockShape source, target;
};

std::vector<Case> Cases() {
  return {
      {"box and stretched box", BoxShape({0.3, 0.2, 0.1}), BoxShape({0.2, 0.25, 0.14})},
      {"arch and box", ArchShape(0.2, 1.2, 0.1, 0.06), BoxShape({0.25, 0.1, 0.06})},
      {"box and arch", BoxShape({0.25, 0.1, 0.06}), ArchShape(0.2, 2, 0.1, 0.06)},
      {"plate and larger hole", PlateShape(0.3, 0.2, 0.02, 0.06),
       PlateShape(0.28, 0.2, 0.03, 0.03)},
      {"cylinder and other radius", CylinderShape(0.05, 0.2), CylinderShape(0.08, 0.15)},
      {"bracket and other fillet", BracketShape(0.2, 0.03, 0.02, 0.1),
       BracketShape(0.22, 0.03, 0.05, 0.08)},
  };
}

Eigen::Vector3d NormalOf(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& t) {
  const Eigen::Vector3d a = vertices.col(t[0]), b = vertices.col(t[1]), c = vertices.col(t[2]);
  return (b - a).cross(c - a);
}

// What the coordinates in the block say.
Eigen::Matrix3Xd KnownImage(const BlockMesh& target, const BlockShape& source) {
  Eigen::Matrix3Xd image(3, static_cast<Eigen::Index>(target.node.size()));
  for (std::size_t v = 0; v < target.node.size(); ++v) {
    image.col(static_cast<Eigen::Index>(v)) = source.image(target.block.col(target.node[v]));
  }
  return image;
}

TEST(SurfaceMapTest, KeepsASurfaceThatIsMappedToItself) {
  for (const Case& of : Cases()) {
    const BlockMesh block = MakeBlockMesh(of.target, {.along = 5, .across = 4, .high = 3});
    ASSERT_OK_AND_ASSIGN(const SurfaceMap map, MapSurface(block.marked, block.marked));
    EXPECT_LT((map.positions - block.marked.surface.vertices).colwise().norm().maxCoeff(), 1e-12)
        << of.name;
  }
}

TEST(SurfaceMapTest, PlacesVerticesOnTheSource) {
  for (const Case& of : Cases()) {
    const BlockMesh source =
        MakeBlockMesh(of.source, {.along = 7, .across = 6, .high = 5, .unrest = 0.2});
    const BlockMesh target = MakeBlockMesh(
        of.target, {.along = 5, .across = 5, .high = 4, .is_mirrored = true, .unrest = 0.2});
    ASSERT_OK_AND_ASSIGN(const SurfaceMap map, MapSurface(source.marked, target.marked));
    const mesh::SurfaceMesh& surface = source.marked.surface;
    const double size = surface.vertices.cwiseAbs().maxCoeff();
    for (std::size_t v = 0; v < map.places.size(); ++v) {
      const TrianglePlace& place = map.places[v];
      ASSERT_GE(place.triangle, 0) << of.name;
      EXPECT_GE(place.barycentric.minCoeff(), 0);
      Eigen::Vector3d on_source = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        on_source +=
            place.barycentric[k] * surface.vertices.col(surface.triangles(k, place.triangle));
      }
      EXPECT_LT((on_source - map.positions.col(static_cast<Eigen::Index>(v))).norm(), 1e-9 * size)
          << of.name;
    }
  }
}

TEST(SurfaceMapTest, FindsTheKnownImageWithinTheMesh) {
  for (const Case& of : Cases()) {
    const BlockMesh source =
        MakeBlockMesh(of.source, {.along = 9, .across = 8, .high = 6, .unrest = 0.15});
    const BlockMesh target = MakeBlockMesh(
        of.target, {.along = 7, .across = 6, .high = 5, .is_mirrored = true, .unrest = 0.15});
    ASSERT_OK_AND_ASSIGN(const SurfaceMap map, MapSurface(source.marked, target.marked));
    const Eigen::Matrix3Xd known = KnownImage(target, of.source);
    const double error = (map.positions - known).colwise().norm().maxCoeff();
    RecordProperty(of.name, std::to_string(error / source.cell_size));
    EXPECT_LT(error, source.cell_size) << of.name;
    const Eigen::Matrix3Xi& triangles = target.marked.surface.triangles;
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      EXPECT_GT(NormalOf(map.positions, triangles.col(t)).dot(NormalOf(known, triangles.col(t))), 0)
          << of.name << ", triangle " << t;
    }
  }
}

}  // namespace
}  // namespace mortise::interpolator
