#include "services/retrieval/families/match_sheet.h"

#include <gtest/gtest.h>

#include "tests/support/png_image.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

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

TEST(FitSheetTest, HasARowForEachDesign) {
  const SheetEntry query{Box({0, 0, 0}, {1, 1, 1}), "query"};
  const FitEntry design{{Box({0, 0, 0}, {1, 1, 2}), "design"}, "3 mm off"};
  const auto one = DrawFitSheet(query, {design});
  const auto two = DrawFitSheet(query, {design, design});
  ASSERT_TRUE(one.ok()) << one.status();
  ASSERT_TRUE(two.ok()) << two.status();
  const auto low = testing::DecodePng(*one);
  const auto high = testing::DecodePng(*two);
  ASSERT_TRUE(low.ok() && high.ok());
  EXPECT_EQ(low->width, high->width);
  EXPECT_NEAR(high->height, 2 * low->height, 40);
}

TEST(FitSheetTest, RefusesNothingToDraw) {
  const SheetEntry box{Box({0, 0, 0}, {1, 1, 1}), "box"};
  EXPECT_TRUE(absl::IsInvalidArgument(DrawFitSheet(box, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(DrawFitSheet(box, {{{{}, "nothing"}, ""}}).status()));
}

}  // namespace
}  // namespace mortise::retrieval
