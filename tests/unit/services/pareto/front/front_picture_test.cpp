// Pictures of fronts: everything is drawn, within the picture, and legible.
#include "services/pareto/front/front_picture.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/random.h"
#include "services/pareto/archive/embedding.h"

namespace mortise::pareto {
namespace {

using render::Drawing;

FrontPicture RandomFront(Eigen::Index d, Eigen::Index D, int count, int pieces) {
  Random random(static_cast<std::uint64_t>(d * 100 + D));
  FrontPicture front;
  front.title = "Trade-offs of templates/table";
  for (Eigen::Index i = 0; i < D; ++i) {
    front.parameter_names.push_back(absl::StrCat("thickness_of_the_table_top_", i));
  }
  for (Eigen::Index m = 0; m < d; ++m) {
    front.metric_names.push_back(absl::StrCat("max_displacement_of_leg_", m));
    front.metric_units.push_back(m == 0 ? "" : "m");
  }
  front.parameters.resize(D, count);
  front.metrics.resize(d, count);
  front.embedding.resize(d - 1, count);
  front.jump = Eigen::VectorXd::Zero(count);
  front.signs = Eigen::VectorXd::Ones(d);
  front.signs[d - 1] = -1;
  front.parameter_ranges = Eigen::VectorXd::Constant(D, 2e-3);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (double& value : front.parameters.col(i)) value = 2e-3 * random.Uniform();
    const Eigen::VectorXd y = random.UnitVector(d).cwiseAbs();
    front.metrics.col(i) = 1e5 * front.signs.cwiseProduct(y);
    front.embedding.col(i) = Embed(y);
    front.piece.push_back(static_cast<int>(random.Index(static_cast<std::size_t>(pieces))));
  }
  return front;
}

// How many discs of points there are in each column of the picture; the legend is below.
std::map<int, int> PointsOfPanels(const Drawing& drawing) {
  std::map<int, int> points;
  for (const auto& mark : drawing.marks()) {
    const auto* const disc = std::get_if<Drawing::Disc>(&mark);
    if (disc != nullptr && disc->centre.y() < drawing.height() - 40) {
      ++points[static_cast<int>(3 * disc->centre.x() / drawing.width())];
    }
  }
  return points;
}

Eigen::AlignedBox2d BoxOf(const Drawing::Text& text) {
  const double capital = 0.72 * text.size, width = render::TextWidth(capital, text.text);
  const double shift = text.anchor == Drawing::Anchor::kStart    ? 0
                       : text.anchor == Drawing::Anchor::kMiddle ? 0.5
                                                                 : 1;
  const Eigen::Vector2d least = text.position - Eigen::Vector2d(shift * width, capital);
  return {least, Eigen::Vector2d(least + Eigen::Vector2d(width, capital))};
}

TEST(FrontPicture, DrawsEveryPointInEveryPanel) {
  for (const Eigen::Index d : {3, 4, 6}) {
    for (const Eigen::Index D : {1, 2, 3, 9}) {
      const Drawing drawing = DrawFront(RandomFront(d, D, 120, 3));
      std::map<int, int> points = PointsOfPanels(drawing);
      EXPECT_EQ(points[0], 120) << d << " " << D;
      EXPECT_EQ(points[1], d == 3 ? 120 : 0) << d << " " << D;  // of more metrics, lines
      EXPECT_EQ(points[2], 120) << d << " " << D;
    }
  }
  std::map<int, int> planar = PointsOfPanels(DrawFront(RandomFront(2, 4, 50, 2)));
  EXPECT_EQ(planar[0], 50);
  EXPECT_EQ(planar[1], 50);
}

TEST(FrontPicture, KeepsTextsApartAndWithinThePicture) {
  for (const Eigen::Index d : {2, 3, 4, 5, 6}) {
    for (const Eigen::Index D : {1, 2, 3, 9}) {
      for (const int pieces : {1, 8, 30}) {
        const Drawing drawing = DrawFront(RandomFront(d, D, 200, pieces));
        const Eigen::AlignedBox2d whole(Eigen::Vector2d(0, 0),
                                        Eigen::Vector2d(drawing.width(), drawing.height()));
        const auto& texts = drawing.texts();
        for (std::size_t i = 0; i < texts.size(); ++i) {
          EXPECT_TRUE(whole.contains(BoxOf(texts[i]))) << texts[i].text << " " << d << " " << D;
          EXPECT_GE(texts[i].size, 11);
          for (std::size_t k = 0; k < i; ++k) {
            const bool apart = BoxOf(texts[i]).intersection(BoxOf(texts[k])).isEmpty();
            EXPECT_TRUE(apart) << texts[i].text << " over " << texts[k].text << ", " << d
                               << " metrics, " << D << " parameters, " << pieces << " pieces";
          }
        }
      }
    }
  }
}

TEST(FrontPicture, MakesDesignsThatJumpDark) {
  FrontPicture front = RandomFront(3, 2, 40, 1);
  front.jump[7] = 0.9;
  const Drawing drawing = DrawFront(front);
  int dark = 0;
  for (const auto& mark : drawing.marks()) {
    const auto* const disc = std::get_if<Drawing::Disc>(&mark);
    if (disc == nullptr || disc->centre.y() > drawing.height() - 40) continue;
    const auto& [red, green, blue] = disc->color;
    dark += std::max({red, green, blue}) < 0.4 ? 1 : 0;
  }
  EXPECT_EQ(dark, 3);
}

// Metrics between 293.3 and 293.5, all of which are 293 in three digits.
TEST(FrontPicture, WritesTheEndsOfNarrowRangesApart) {
  for (const Eigen::Index d : {2, 3, 4}) {
    FrontPicture front = RandomFront(d, 4, 60, 1);
    for (Eigen::Index m = 0; m < d; ++m) {
      front.metrics.row(m) = (293.4 + 1e-6 * front.metrics.row(m).array()).eval();
    }
    const Drawing drawing = DrawFront(front);
    Eigen::Index numbers = 0;
    for (const Drawing::Text& text : drawing.texts()) {
      if (text.text.starts_with("29")) ++numbers;
      EXPECT_NE(text.text, "293") << d;
    }
    EXPECT_GE(numbers, 2 * d) << d;
  }
}

// Of more points than there is room for lines the ends are drawn, whichever they are.
TEST(FrontPicture, DrawsTheBestOfEachMetricOfMany) {
  FrontPicture front = RandomFront(4, 4, 1001, 1);
  const auto lines = [&] {
    std::size_t count = 0;
    const Drawing drawing = DrawFront(front);
    for (const auto& mark : drawing.marks()) {
      const auto* const line = std::get_if<Drawing::Line>(&mark);
      if (line != nullptr && line->points.size() == 4 && line->width == 0.7) ++count;
    }
    return count;
  };
  // Every fifth is drawn. With all ends among these there are no others.
  for (Eigen::Index m = 0; m < 4; ++m) {
    front.metrics(m, 0) = 2e5;
    front.metrics(m, 5) = -2e5;
  }
  EXPECT_EQ(lines(), 201u);
  front.metrics(2, 998) = 3e5;
  EXPECT_EQ(lines(), 202u);
  front.metrics(0, 1) = -3e5;
  EXPECT_EQ(lines(), 203u);
}

TEST(FrontPicture, DrawsFrontsOfOnePoint) {
  for (const Eigen::Index d : {2, 3, 5}) {
    FrontPicture front = RandomFront(d, 4, 1, 1);
    EXPECT_TRUE(render::DrawingSvg(DrawFront(front)).ok()) << d;
    front.parameter_ranges.setZero();
    EXPECT_TRUE(render::DrawingSvg(DrawFront(front)).ok()) << d;
  }
}

}  // namespace
}  // namespace mortise::pareto
