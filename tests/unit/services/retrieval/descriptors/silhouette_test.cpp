#include "services/retrieval/descriptors/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mortise::retrieval {
namespace {

// A square of two triangles between two corners, added to points and triangles.
struct Drawing {
  Eigen::Matrix2Xd points{2, 0};
  Eigen::Matrix3Xi triangles{3, 0};

  Drawing& Add(double left, double bottom, double right, double top) {
    const int first = static_cast<int>(points.cols());
    points.conservativeResize(2, first + 4);
    points.rightCols(4) << left, right, right, left, bottom, bottom, top, top;
    triangles.conservativeResize(3, triangles.cols() + 2);
    triangles.rightCols(2) << first, first, first + 1, first + 2, first + 2, first + 3;
    return *this;
  }
};

// In the window from `corner` of the given size.
Silhouette Draw(const Drawing& drawing, const Eigen::Vector2d& corner = {0, 0}, double size = 4) {
  return SilhouetteRaster(128, corner, size).Draw(drawing.points, drawing.triangles);
}

double AreaOf(const Silhouette& silhouette) {
  double length = 0;
  for (const Span& span : silhouette.spans) length += span.end - span.begin;
  return length * silhouette.row_height;
}

Eigen::Vector2d CentroidOf(const Silhouette& silhouette) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Span& span : silhouette.spans) {
    sum += (span.end - span.begin) * Eigen::Vector2d((span.begin + span.end) / 2, span.y);
  }
  return sum * silhouette.row_height / AreaOf(silhouette);
}

TEST(SilhouetteTest, CountsOverlapsOnceAndKeepsHoles) {
  EXPECT_NEAR(AreaOf(Draw(Drawing().Add(0, 0, 4, 4))), 16, 1e-6);
  EXPECT_NEAR(AreaOf(Draw(Drawing().Add(0, 0, 4, 4).Add(1, 1, 2, 2))), 16, 1e-6);
  EXPECT_NEAR(AreaOf(Draw(Drawing().Add(0, 0, 3, 3).Add(1, 1, 4, 4))), 14, 0.1);
  // A frame around 2 × 2.
  const Silhouette frame =
      Draw(Drawing().Add(0, 0, 4, 1).Add(0, 3, 4, 4).Add(0, 0, 1, 4).Add(3, 0, 4, 4));
  EXPECT_NEAR(AreaOf(frame), 12, 1e-6);
  for (const Span& span : frame.spans) {
    EXPECT_FALSE(span.begin < 2 && span.end > 2 && span.y > 1 && span.y < 3);
  }
}

TEST(SilhouetteTest, HasTheCentroidOfWhatIsCovered) {
  const Eigen::Vector2d centroid =
      CentroidOf(Draw(Drawing().Add(10, 0, 14, 4).Add(14, 0, 18, 2), {10, 0}, 8));
  EXPECT_NEAR(centroid.x(), (16 * 12 + 8 * 16) / 24.0, 1e-4);
  EXPECT_NEAR(centroid.y(), (16 * 2 + 8 * 1) / 24.0, 1e-2);
}

TEST(SilhouetteTest, HasTheAreaOfADisc) {
  constexpr int kSides = 720;
  Drawing disc;
  disc.points.resize(2, kSides + 1);
  disc.points.col(kSides) << 7, -3;
  disc.triangles.resize(3, kSides);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * M_PI * i / kSides;
    disc.points.col(i) << 7 + 2 * std::cos(angle), -3 + 2 * std::sin(angle);
    disc.triangles.col(i) << i, (i + 1) % kSides, kSides;
  }
  const Silhouette silhouette = Draw(disc, {5, -5}, 4);
  EXPECT_NEAR(AreaOf(silhouette), 4 * M_PI, 4 * M_PI * 1e-3);
  EXPECT_TRUE(CentroidOf(silhouette).isApprox(Eigen::Vector2d(7, -3), 1e-5));
}

TEST(SilhouetteTest, IsContinuousAsEdgesMove) {
  // A slanted sheet: its area follows its width by far less than a row's or column's size.
  const auto area = [](double width) {
    Drawing sheet;
    sheet.points.resize(2, 4);
    sheet.points << 0, width, width + 1, 1, 0, 0.3, 3.3, 3;
    sheet.triangles.resize(3, 2);
    sheet.triangles << 0, 0, 1, 2, 2, 3;
    return AreaOf(Draw(sheet));
  };
  for (int step = 1; step < 50; ++step) {
    const double width = 1 + 0.001 * step;
    EXPECT_NEAR(area(width) - area(width - 0.001), 0.001 * 2.7 + 0.0003, 5e-4);
  }
}

TEST(SilhouetteTest, SplitTrianglesCoverTheSame) {
  Drawing tiles;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) tiles.Add(i, j, i + 1, j + 1);
  }
  EXPECT_NEAR(AreaOf(Draw(tiles, {0, 0}, 20)), 400, 1e-3);
  EXPECT_EQ(Draw(tiles, {0, 0}, 20).spans.size(), 128U);
}

TEST(SilhouetteTest, ALineCoversNothing) {
  EXPECT_EQ(AreaOf(Draw(Drawing().Add(0, 0, 3, 0))), 0);
  EXPECT_EQ(AreaOf(Draw(Drawing().Add(1, 1, 1, 1))), 0);
}

}  // namespace
}  // namespace mortise::retrieval
