// Drawings look the same as SVG and as picture.
#include "common/render/drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mortise::render {
namespace {

constexpr Color kRed{1, 0, 0}, kBlue{0, 0, 1};

Drawing Marks() {
  Drawing drawing(100, 60);
  drawing.Add(Drawing::Area{{{10, 10}, {40, 10}, {40, 40}, {10, 40}}, kRed});
  drawing.Add(Drawing::Disc{{70, 30}, 15, kBlue});
  drawing.Add(Drawing::Line{{{5, 55}, {95, 55}}, kRed, 4});
  drawing.Add(Drawing::Text{{50, 50}, "a < b & c", 12, Drawing::Anchor::kMiddle});
  return drawing;
}

TEST(Drawing, AsSvg) {
  const std::string svg = *DrawingSvg(Marks());
  EXPECT_NE(svg.find("<polygon points=\"10.00,10.00 40.00,10.00"), std::string::npos);
  EXPECT_NE(svg.find("<circle cx=\"70.00\" cy=\"30.00\" r=\"15.00\" fill=\"#0000ff\"/>"),
            std::string::npos);
  EXPECT_NE(svg.find("a &lt; b &amp; c</text>"), std::string::npos);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

TEST(Drawing, AsImageOfTheSameShapes) {
  for (const int scale : {1, 2, 3}) {
    const Image image = *DrawingImage(Marks(), scale);
    EXPECT_EQ(image.width, 100 * scale);
    EXPECT_EQ(image.height, 60 * scale);
    const auto at = [&](int x, int y) { return image.Get(scale * x, scale * y); };
    EXPECT_EQ(at(25, 25), kRed);
    EXPECT_EQ(at(70, 30), kBlue);
    EXPECT_EQ(at(82, 30), kBlue);
    EXPECT_EQ(at(82, 42), (Color{1, 1, 1}));  // beside the disc
    EXPECT_EQ(at(50, 55), kRed);
    EXPECT_EQ(at(5, 5), (Color{1, 1, 1}));
    // Of the area of each, what is covered: within a pixel along its rim.
    int blue = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) blue += image.Get(x, y) == kBlue ? 1 : 0;
    }
    EXPECT_NEAR(blue / std::pow(scale, 2), M_PI * 225, 2 * M_PI * 15);
  }
}

TEST(Drawing, RefusesWhatCannotBeDrawn) {
  EXPECT_TRUE(absl::IsInvalidArgument(DrawingSvg(Drawing(0, 100)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(DrawingImage(Drawing(100, 100000)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(DrawingImage(Drawing(100, 100), 0).status()));
  Drawing drawing(100, 100);
  drawing.Add(Drawing::Disc{{std::numeric_limits<double>::quiet_NaN(), 0}, 1, kRed});
  EXPECT_TRUE(absl::IsInvalidArgument(DrawingSvg(drawing).status()));
}

TEST(Drawing, ShortensTextsToTheirPlace) {
  EXPECT_EQ(Shortened("mass", 12, 200), "mass");
  const std::string cut = Shortened("max_displacement_of_everything", 12, 80);
  EXPECT_TRUE(cut.ends_with(".."));
  EXPECT_LE(TextWidth(0.72 * 12, cut), 80);
  EXPECT_GT(cut.size(), 5u);
  EXPECT_EQ(Shortened("µµµµ", 12, 20).size() % 2, 0u);  // whole characters
}

}  // namespace
}  // namespace mortise::render
