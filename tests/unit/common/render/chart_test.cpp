// Values stand where their axes say.
#include "common/render/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace mortise::render {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

ChartPanel Costs() {
  return {.title = "table",
          .x_name = "δ",
          .y_name = "cost",
          .x_logarithmic = true,
          .y_logarithmic = true,
          .series = {{"points", {0.01, 0.1, 1}, {1000, 100, 10}, PartColor(0)},
                     {"tangents", {0.01, 0.1, 1}, {50, kNothing, 20}, PartColor(1)}}};
}

TEST(Chart, SharesOfASpan) {
  EXPECT_DOUBLE_EQ((AxisSpan{2, 4}.Share(3)), 0.5);
  EXPECT_DOUBLE_EQ((AxisSpan{0.01, 1, true}.Share(0.1)), 0.5);
}

TEST(Chart, SpansOfValues) {
  const AxisSpan span = SpanOf({3, -1, kNothing, 2});
  EXPECT_EQ(span.least, -1);
  EXPECT_EQ(span.most, 3);
  const AxisSpan positive = SpanOf({0, -1, 5, 2}, true);
  EXPECT_EQ(positive.least, 2);
  EXPECT_EQ(positive.most, 5);
  for (const bool logarithmic : {false, true}) {
    for (const AxisSpan& thin : {SpanOf({7, 7}, logarithmic), SpanOf({}, logarithmic)}) {
      EXPECT_LT(thin.least, thin.most);
      EXPECT_TRUE(!logarithmic || thin.least > 0);
    }
  }
}

TEST(Chart, AxesPlaceValuesInOrderAndWithinTheirFrame) {
  const Frame frame{100, 50, 300, 200};
  const Axes axes(frame, {1, 100, true}, {-1, 1});
  const Eigen::Vector2d lowest = axes.At(1, -1), middle = axes.At(10, 0), highest = axes.At(100, 1);
  EXPECT_LT((middle - (lowest + highest) / 2).norm(), 1e-9);
  EXPECT_GT(lowest.x(), 100);
  EXPECT_LT(highest.x(), 400);
  EXPECT_LT(lowest.y(), 250);  // y of a drawing grows downwards
  EXPECT_GT(highest.y(), 50);
  EXPECT_GT(lowest.y(), highest.y());
}

TEST(Chart, DrawsEachPointThatThereIsAndOneLegend) {
  ChartPanel other = Costs();
  other.title = "cart";
  const Drawing drawing = DrawChart({Costs(), other}, {.columns = 2});
  const std::string svg = *DrawingSvg(drawing);
  EXPECT_EQ(Count(svg, ">points</text>"), 1);
  EXPECT_EQ(Count(svg, ">tangents</text>"), 1);
  EXPECT_EQ(Count(svg, ">cart</text>"), 1);
  EXPECT_EQ(Count(svg, "<circle"), 2 * (3 + 2) + 2);  // with those of the legend
  // The line of the tangents is broken where they have no value, and never drawn.
  EXPECT_EQ(Count(svg, HexColor(PartColor(0)) + "\" stroke-width=\"2.00\""), 2 + 1);
  EXPECT_EQ(Count(svg, HexColor(PartColor(1)) + "\" stroke-width=\"2.00\""), 1);
}

TEST(Chart, LeavesOutWhatALogarithmicAxisCannotShow) {
  ChartPanel panel = Costs();
  panel.series = {{"errors", {0.1, 0.2, 0.3}, {0, -1, 5}, PartColor(2)}};
  const std::string svg = *DrawingSvg(DrawChart({panel}));
  EXPECT_EQ(Count(svg, "<circle"), 1 + 1);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Chart, LogarithmicAxesHaveRoundNumbers) {
  const std::string svg = *DrawingSvg(DrawChart({Costs()}));
  for (const char* number : {">0.01<", ">0.1<", ">1<", ">10<", ">100<", ">1000<"}) {
    EXPECT_EQ(Count(svg, number), 1) << number;
  }
}

TEST(Chart, HasRoomForWhatItDraws) {
  const Drawing drawing = DrawChart({Costs(), Costs(), Costs(), Costs()}, {.columns = 3});
  EXPECT_EQ(drawing.width(), 3 * 330);
  EXPECT_GT(drawing.height(), 2 * 270);
  for (const Drawing::Text& text : drawing.texts()) {
    EXPECT_GE(text.position.x(), 0);
    EXPECT_LE(text.position.x(), drawing.width());
    EXPECT_LE(text.position.y(), drawing.height());
  }
}

}  // namespace
}  // namespace mortise::render
