// PNG, text and contact sheets.
#include "common/render/image.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "tests/support/png_image.h"

namespace mortise::render {
namespace {

TEST(Png, KeepsEveryPixel) {
  Image image(13, 7, {0.2, 0.4, 0.6});
  image.Set(5, 3, {1, 0, 0});
  const auto png = EncodePng(image);
  ASSERT_TRUE(png.ok()) << png.status();
  EXPECT_EQ(png->substr(1, 3), "PNG");
  const auto back = testing::DecodePng(*png);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->width, 13);
  EXPECT_EQ(back->height, 7);
  EXPECT_EQ(back->pixels, image.pixels);
}

TEST(Png, RefusesEmptyAndBroken) {
  EXPECT_FALSE(EncodePng(Image()).ok());
  Image wrong(4, 4, {1, 1, 1});
  wrong.pixels.pop_back();
  EXPECT_FALSE(EncodePng(wrong).ok());
  EXPECT_FALSE(testing::DecodePng("").ok());
  EXPECT_FALSE(testing::DecodePng("not a picture").ok());
  std::string cut = *EncodePng(Image(20, 20, {0, 0, 0}));
  cut.resize(cut.size() / 2);
  EXPECT_FALSE(testing::DecodePng(cut).ok());
}

TEST(Text, EveryPrintableCharacterLeavesInkWithinItsWidth) {
  for (char c = '!'; c <= '~'; ++c) {
    Image image(60, 60, {1, 1, 1});
    const std::string text(1, c);
    DrawText(image, 15, 15, 24, {0, 0, 0}, text);
    int ink = 0;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 60; ++x) {
        if (image.Get(x, y).red > 0.5) continue;
        ++ink;
        EXPECT_GE(x, 12) << c;
        EXPECT_LE(x, 18 + TextWidth(24, text)) << c;
      }
    }
    EXPECT_GE(ink, 6) << c;
  }
}

TEST(Text, WidthGrowsWithTextAndHeight) {
  EXPECT_EQ(TextWidth(10, ""), 0);
  EXPECT_GT(TextWidth(10, "table"), TextWidth(10, "tab"));
  EXPECT_NEAR(TextWidth(20, "table"), 2 * TextWidth(10, "table"), 1e-12);
  EXPECT_GT(TextWidth(10, "N/m²"), TextWidth(10, "N/m"));
}

TEST(Colors, FieldMapIsClampedAndBrightens) {
  EXPECT_EQ(FieldColor(-1), FieldColor(0));
  EXPECT_EQ(FieldColor(2), FieldColor(1));
  const auto brightness = [](const Color& c) {
    return 0.3 * c.red + 0.59 * c.green + 0.11 * c.blue;
  };
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT(brightness(FieldColor(i / 20.0)), brightness(FieldColor((i + 1) / 20.0)));
  }
  EXPECT_EQ(HexColor({1, 0.5, 0}), "#ff8000");
}

TEST(ContactSheets, HoldEveryPictureAndCaption) {
  const std::vector<Image> pictures(5, Image(40, 30, {0.1, 0.2, 0.3}));
  const auto sheet = ContactSheet(pictures, {"a", "b", "c", "d", "e"}, 3);
  ASSERT_TRUE(sheet.ok()) << sheet.status();
  EXPECT_GE(sheet->width, 3 * 40);
  EXPECT_GE(sheet->height, 2 * 30);
  EXPECT_FALSE(ContactSheet({}, {}, 3).ok());
  EXPECT_FALSE(ContactSheet(pictures, {"a"}, 3).ok());
  EXPECT_FALSE(ContactSheet(pictures, {"a", "b", "c", "d", "e"}, 0).ok());
}

}  // namespace
}  // namespace mortise::render
