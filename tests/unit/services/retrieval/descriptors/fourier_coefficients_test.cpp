#include "services/retrieval/descriptors/fourier_coefficients.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace mortise::retrieval {
namespace {

constexpr int kOrder = 10;
constexpr int kRows = 2000;

// A convex polygon of corners on the unit circle, counter-clockwise, as rows.
Silhouette Polygon(const Eigen::Matrix2Xd& corners) {
  Silhouette silhouette{{}, 2.0 / kRows};
  for (int i = 0; i < kRows; ++i) {
    const double y = 2 * (i + 0.5) / kRows - 1;
    double begin = 2, end = -2;
    for (Eigen::Index k = 0; k < corners.cols(); ++k) {
      const Eigen::Vector2d a = corners.col(k), b = corners.col((k + 1) % corners.cols());
      if ((a.y() < y) == (b.y() < y)) continue;
      const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      begin = std::min(begin, x);
      end = std::max(end, x);
    }
    if (end > begin) silhouette.spans.push_back({y, begin, end});
  }
  return silhouette;
}

Eigen::Matrix2Xd Corners(int sides, double first = 0) {
  Eigen::Matrix2Xd corners(2, sides);
  for (int i = 0; i < sides; ++i) {
    const double angle = first + 2 * M_PI * i / sides;
    corners.col(i) << std::cos(angle), std::sin(angle);
  }
  return corners;
}

Eigen::VectorXd Coefficients(const Silhouette& silhouette, double turn = 0) {
  return FourierCoefficients(kOrder).Of(silhouette, turn);
}

TEST(FourierCoefficientsTest, OfADiscAreItsRadius) {
  const Eigen::VectorXd disc = Coefficients(Polygon(0.6 * Corners(720)));
  ASSERT_EQ(disc.size(), 21);
  EXPECT_NEAR(disc[0], 0.6, 1e-3);
  EXPECT_LT(disc.tail(20).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(FourierCoefficientsTest, OfASquareAreThoseOfTheDistanceToItsSides) {
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(21);
  constexpr int kDirections = 20000;
  for (int j = 0; j < kDirections; ++j) {
    const double angle = 2 * M_PI * j / kDirections;
    const double distance = 1 / (std::abs(std::cos(angle)) + std::abs(std::sin(angle)));
    expected[0] += distance / kDirections;
    for (int k = 1; k <= kOrder; ++k) {
      expected[2 * k - 1] += std::sqrt(2) * distance * std::cos(k * angle) / kDirections;
      expected[2 * k] += std::sqrt(2) * distance * std::sin(k * angle) / kDirections;
    }
  }
  EXPECT_LT((Coefficients(Polygon(Corners(4))) - expected).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_GT(std::abs(expected[7]), 0.02);
}

TEST(FourierCoefficientsTest, OfWhatRaysLeaveSeveralTimesAreTheLengthsCovered) {
  // A ring between radii 0.5 and 0.9.
  Silhouette ring = Polygon(0.9 * Corners(720));
  const Silhouette hole = Polygon(0.5 * Corners(720));
  const Eigen::VectorXd expected = Coefficients(ring) - Coefficients(hole);
  EXPECT_NEAR(expected[0], 0.4, 1e-3);
  std::vector<Span> spans;
  for (const Span& row : ring.spans) {
    const auto inner = std::find_if(hole.spans.begin(), hole.spans.end(),
                                    [&](const Span& other) { return other.y == row.y; });
    if (inner == hole.spans.end()) {
      spans.push_back(row);
    } else {
      spans.push_back({row.y, row.begin, inner->begin});
      spans.push_back({row.y, inner->end, row.end});
    }
  }
  ring.spans = spans;
  EXPECT_TRUE(Coefficients(ring).isApprox(expected, 1e-9));
}

TEST(FourierCoefficientsTest, AreThoseBeforeATurn) {
  const Eigen::Matrix2d shear = (Eigen::Matrix2d() << 1, 0.3, -0.2, 0.7).finished() * 0.7;
  const Eigen::Matrix2d turn =
      (Eigen::Matrix2d() << std::cos(0.5), -std::sin(0.5), std::sin(0.5), std::cos(0.5)).finished();
  const Eigen::VectorXd before = Coefficients(Polygon(shear * Corners(5)));
  const Silhouette turned = Polygon(turn * shear * Corners(5));
  EXPECT_LT((Coefficients(turned, 0.5) - before).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_GT((Coefficients(turned) - before).cwiseAbs().maxCoeff(), 0.02);
}

TEST(FourierCoefficientsTest, ChangeSignsIfRightAndLeftAreExchanged) {
  const Eigen::Matrix2d shear = (Eigen::Matrix2d() << 1, 0.3, -0.2, 0.7).finished() * 0.7;
  const Silhouette pentagon = Polygon(shear * Corners(5));
  Silhouette mirrored = pentagon;
  for (Span& span : mirrored.spans) span = {span.y, -span.end, -span.begin};
  const Eigen::VectorXd signs = FourierCoefficients(kOrder).MirrorSigns();
  EXPECT_LT((signs.cwiseProduct(Coefficients(pentagon)) - Coefficients(mirrored)).norm(), 1e-9);
  EXPECT_GT((Coefficients(pentagon) - Coefficients(mirrored)).norm(), 0.01);
}

}  // namespace
}  // namespace mortise::retrieval
