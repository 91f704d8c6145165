// What grids and triangles have in common: one ground, told in both ways.
#include "common/terrain/height_field.h"

#include <gtest/gtest.h>

#include "tests/unit/common/terrain/sampled_extremes.h"

namespace mortise::terrain {
namespace {

// A roof whose ridge runs along x at y = 1: along lines of the grid, so that triangles say the
// same.
double Roof(double y) { return 1 - 0.3 * std::abs(y - 1); }

std::shared_ptr<const HeightField> RoofOfGrid() {
  Eigen::MatrixXd heights(3, 3);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) heights(i, k) = Roof(k);
  }
  return HeightField::Create(HeightGrid{.heights = heights}).value();
}

std::shared_ptr<const HeightField> RoofOfTriangles() {
  HeightTriangles roof;
  roof.vertices.resize(3, 6);
  roof.vertices << 0, 2, 0, 2, 0, 2,  //
      0, 0, 1, 1, 2, 2,               //
      Roof(0), Roof(0), Roof(1), Roof(1), Roof(2), Roof(2);
  roof.triangles.resize(3, 4);
  roof.triangles << 0, 1, 2, 3,  //
      1, 3, 3, 5,                //
      2, 2, 4, 4;
  return HeightField::Create(std::move(roof)).value();
}

TEST(HeightField, IsTheSameAsGridAndAsTriangles) {
  const auto grid = RoofOfGrid(), triangles = RoofOfTriangles();
  std::mt19937 random(11);
  for (int round = 0; round < 50; ++round) {
    const Rectangle rectangle = RandomRectangle(random, 2, 2);
    ASSERT_OK_AND_ASSIGN(const RectangleValue one, grid->HighestUnder(rectangle));
    ASSERT_OK_AND_ASSIGN(const RectangleValue other, triangles->HighestUnder(rectangle));
    EXPECT_NEAR(one.value, other.value, 1e-12);
    ASSERT_OK_AND_ASSIGN(const RectangleValue low, grid->LowestUnder(rectangle));
    ASSERT_OK_AND_ASSIGN(const RectangleValue other_low, triangles->LowestUnder(rectangle));
    EXPECT_NEAR(low.value, other_low.value, 1e-12);
    EXPECT_NEAR((low.gradient - other_low.gradient).norm(), 0, 1e-9);
    EXPECT_NEAR(grid->SlopeAt(rectangle.to_x, rectangle.to_y)->value, 0.3, 1e-12);
    EXPECT_NEAR(triangles->SlopeAt(rectangle.to_x, rectangle.to_y)->value, 0.3, 1e-12);
  }
}

TEST(HeightField, GivesBackWhatItWasMadeOf) {
  EXPECT_EQ(std::get<HeightGrid>(RoofOfGrid()->Given()).heights.rows(), 3);
  EXPECT_EQ(std::get<HeightTriangles>(RoofOfTriangles()->Given()).triangles.cols(), 4);
  EXPECT_GT(RoofOfTriangles()->MemoryUse(), RoofOfGrid()->MemoryUse());
}

}  // namespace
}  // namespace mortise::terrain
