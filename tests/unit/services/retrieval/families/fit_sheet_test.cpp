#include "services/retrieval/families/fit_sheet.h"

#include <gtest/gtest.h>

#include "tests/support/png_image.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

TEST(FitSheetTest, HasARowForEachDesign) {
  const FitSheetEntry query{Box({0, 0, 0}, {1, 1, 1}), "query"};
  const FitSheetEntry design{Box({0, 0, 0}, {1, 1, 2}), "design"};
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
  const FitSheetEntry box{Box({0, 0, 0}, {1, 1, 1}), "box"};
  EXPECT_TRUE(absl::IsInvalidArgument(DrawFitSheet(box, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(DrawFitSheet(box, {{{}, "nothing"}}).status()));
}

}  // namespace
}  // namespace mortise::retrieval
