#include "services/retrieval/families/match_sheet.h"

#include <gtest/gtest.h>

#include "tests/support/png_image.h"

namespace mortise::retrieval {
namespace {

mesh::SurfaceMesh Triangle(double size) {
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 3);
  surface.vertices << 0, size, 0, 0, 0, size, 0, 0, size;
  surface.triangles.resize(3, 1);
  surface.triangles << 0, 1, 2;
  return surface;
}

TEST(MatchSheetTest, ShowsShapesOfAnySizeSideBySide) {
  const auto one = DrawMatchSheet({{Triangle(1), "query"}});
  const auto three =
      DrawMatchSheet({{Triangle(1), "query"}, {Triangle(1e-6), "small"}, {Triangle(1e6), "large"}});
  ASSERT_TRUE(one.ok()) << one.status();
  ASSERT_TRUE(three.ok()) << three.status();
  const auto narrow = testing::DecodePng(*one);
  const auto wide = testing::DecodePng(*three);
  ASSERT_TRUE(narrow.ok() && wide.ok());
  EXPECT_GT(wide->width, 2 * narrow->width);
  EXPECT_EQ(wide->height, narrow->height);
}

TEST(MatchSheetTest, RefusesNothingToDraw) {
  EXPECT_TRUE(absl::IsInvalidArgument(DrawMatchSheet({}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(DrawMatchSheet({{mesh::SurfaceMesh{}, "nothing"}}).status()));
}

}  // namespace
}  // namespace mortise::retrieval
