// Axes, ticks and the SVG text of plots.
#include "common/render/svg_plot.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "common/base/errors.h"
#include "common/base/files.h"

namespace mortise::render {
namespace {

TEST(Ticks, AreRoundAndInside) {
  EXPECT_EQ(NiceTicks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  for (const double low : {-3.7, 0.0, 1e-7, 2e8}) {
    for (const double range : {1e-3, 0.9, 47.0, 1e6}) {
      const auto ticks = NiceTicks(low, low + range, 6);
      EXPECT_GE(ticks.size(), 3u);
      EXPECT_LE(ticks.size(), 13u);
      EXPECT_GE(ticks.front(), low - 1e-6 * range);
      EXPECT_LE(ticks.back(), low + range * (1 + 1e-6));
    }
  }
}

TEST(Numbers, AreShort) {
  EXPECT_EQ(ShortNumber(0), "0");
  EXPECT_EQ(ShortNumber(0.25), "0.25");
  EXPECT_EQ(ShortNumber(1234.5), "1234");
  EXPECT_EQ(ShortNumber(-12), "-12");
  EXPECT_EQ(ShortNumber(1.5e9), "1.5e9");
  EXPECT_EQ(ShortNumber(2e-7), "2e-7");
}

TEST(Numbers, OfOneAxisDiffer) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(ShortNumbers({0, 0.5, 1}), (Texts{"0", "0.5", "1"}));
  EXPECT_EQ(ShortNumbers({293.15, 293.4}, 3), (Texts{"293.1", "293.4"}));
  EXPECT_EQ(ShortNumbers({1e7, 1e7 + 1}, 3), (Texts{"1e7", "1.0000001e7"}));
  EXPECT_EQ(ShortNumbers({2, 2}, 3), (Texts{"2", "2"}));
  EXPECT_TRUE(ShortNumbers({}).empty());
}

Plot Front() {
  Plot plot;
  plot.title = "Table: mass against deflection";
  plot.x_label = "mass (kg)";
  plot.y_label = "deflection (mm)";
  Series front, cloud;
  front.name = "front";
  front.line = true;
  front.points.resize(2, 12);
  cloud.name = "evaluated";
  cloud.points.resize(2, 12);
  for (int i = 0; i < 12; ++i) {
    front.points.col(i) << 12 + i, 60.0 / (i + 2) - 3;
    cloud.points.col(i) << 13 + i + 0.3 * (i % 3), 60.0 / (i + 2) + 2 * (i % 4);
  }
  plot.series = {front, cloud};
  plot.callouts.push_back({15, 9, "chosen <15 kg>"});
  return plot;
}

TEST(Plots, NameTheirAxesAndSeriesEscaped) {
  const auto svg = PlotSvg(Front());
  ASSERT_TRUE(svg.ok()) << svg.status();
  for (const char* text : {"<svg", "mass (kg)", "deflection (mm)", ">front<", "chosen &lt;15 kg"}) {
    EXPECT_NE(svg->find(text), std::string::npos) << text;
  }
  EXPECT_EQ(svg->find("nan"), std::string::npos);
  if (const char* folder = std::getenv("MORTISE_PICTURES")) {
    ASSERT_TRUE(WriteFile(std::filesystem::path(folder) / "front.svg", *svg).ok());
  }
}

TEST(Plots, LeaveOutWhatCannotBeShown) {
  Plot plot = Front();
  plot.series[0].points(1, 3) = std::numeric_limits<double>::quiet_NaN();
  plot.series[1].points(0, 2) = -1;
  plot.logarithmic_x = plot.logarithmic_y = true;
  const auto svg = PlotSvg(plot);
  ASSERT_TRUE(svg.ok());
  EXPECT_EQ(svg->find("nan"), std::string::npos);
  EXPECT_EQ(svg->find("inf"), std::string::npos);
}

TEST(Plots, ASinglePointHasAxes) {
  Plot plot;
  Series one;
  one.points.resize(2, 1);
  one.points << 3, 0;
  plot.series.push_back(one);
  const auto svg = PlotSvg(plot);
  ASSERT_TRUE(svg.ok());
  EXPECT_NE(svg->find("<circle"), std::string::npos);
}

TEST(Plots, RefuseNothingAndAbsurdSizes) {
  EXPECT_EQ(DetailOf(PlotSvg(Plot{}).status()).field, "plot.series");
  Plot plot = Front();
  plot.width = 5;
  EXPECT_EQ(DetailOf(PlotSvg(plot).status()).field, "plot.width");
}

}  // namespace
}  // namespace mortise::render
