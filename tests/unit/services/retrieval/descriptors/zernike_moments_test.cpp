#include "services/retrieval/descriptors/zernike_moments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mortise::retrieval {
namespace {

constexpr int kRows = 2000;
constexpr int kOrder = 10;

// What lies within [-1, 1]², by rows.
template <typename Row>  // y -> begin and end of the row
Silhouette Rows(const Row& row) {
  Silhouette silhouette{{}, 2.0 / kRows};
  for (int i = 0; i < kRows; ++i) {
    const double y = 2 * (i + 0.5) / kRows - 1;
    const auto [begin, end] = row(y);
    if (end > begin) silhouette.spans.push_back({y, begin, end});
  }
  return silhouette;
}

Silhouette Ellipse(double a, double b) {
  return Rows([=](double y) {
    const double x = std::abs(y) < b ? a * std::sqrt(1 - y * y / (b * b)) : 0;
    return std::pair(-x, x);
  });
}

// The place of the moment with R_nm, or with its cosine, among all.
Eigen::Index Place(int n, int m) {
  const Eigen::Index place = n * (n + 1) / 2;
  return m == 0 ? place : place + m - 1;
}

Eigen::VectorXd Moments(const Silhouette& silhouette, double turn = 0) {
  return ZernikeMoments(kOrder).Of(silhouette, Eigen::Vector2d::Zero(), 1, turn);
}

TEST(ZernikeMomentsTest, AreSixtySix) { EXPECT_EQ(ZernikeMoments(kOrder).size(), 66); }

TEST(ZernikeMomentsTest, OfTheWholeDiscAreZeroButTheFirst) {
  const Eigen::VectorXd moments = Moments(Ellipse(1, 1));
  EXPECT_NEAR(moments[0], 1, 1e-4);
  EXPECT_LT(moments.tail(65).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ZernikeMomentsTest, OfASmallerDiscAreTheIntegralsOfTheRadialPolynomials) {
  // Over a disc of radius s, with t = s², the means are those of R_00: t, R_20: t (t - 1), and
  // R_40: t (2t² - 3t + 1).
  const double t = 0.49;
  Eigen::VectorXd moments = Moments(Ellipse(0.7, 0.7));
  EXPECT_NEAR(moments[Place(0, 0)], t, 1e-4);
  EXPECT_NEAR(moments[Place(2, 0)], std::sqrt(3) * t * (t - 1), 1e-3);
  EXPECT_NEAR(moments[Place(4, 0)], std::sqrt(5) * t * (2 * t * t - 3 * t + 1), 1e-3);
  for (int n = 0; n <= kOrder; n += 2) moments[Place(n, 0)] = 0;
  EXPECT_LT(moments.cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ZernikeMomentsTest, OfAnEllipseAreTheKnownOnes) {
  // ∫ x² over an ellipse is π a³ b / 4; R_22 cos 2θ is x² - y², R_20 is 2(x² + y²) - 1.
  const double a = 0.9, b = 0.4;
  const Eigen::VectorXd moments = Moments(Ellipse(a, b));
  EXPECT_NEAR(moments[Place(2, 2)], std::sqrt(6) * a * b * (a * a - b * b) / 4, 1e-3);
  EXPECT_NEAR(moments[Place(2, 2) + 1], 0, 1e-9);
  EXPECT_NEAR(moments[Place(2, 0)], std::sqrt(3) * a * b * ((a * a + b * b) / 2 - 1), 1e-3);
  EXPECT_NEAR(moments[Place(1, 1)], 0, 1e-9);
  EXPECT_NEAR(moments[Place(3, 3)], 0, 1e-9);
}

TEST(ZernikeMomentsTest, MeasureTheShareOfTheDiscInWhichSilhouettesDiffer) {
  const double difference = 0.9 * 0.8 - 0.9 * 0.4;
  const double squared = (Moments(Ellipse(0.9, 0.8)) - Moments(Ellipse(0.9, 0.4))).squaredNorm();
  EXPECT_LT(squared, difference);
  EXPECT_GT(squared, 0.7 * difference);
}

// Half of an ellipse, long along x, and the same turned by a quarter.
Silhouette RightHalf() {
  return Rows([](double y) {
    return std::pair(0.0, std::abs(y) < 0.4 ? 0.9 * std::sqrt(1 - y * y / 0.16) : 0.0);
  });
}

Silhouette UpperHalf() {
  return Rows([](double y) {
    const double x = y > 0 && y < 0.9 ? 0.4 * std::sqrt(1 - y * y / 0.81) : 0.0;
    return std::pair(-x, x);
  });
}

TEST(ZernikeMomentsTest, AreThoseBeforeATurn) {
  EXPECT_LT((Moments(RightHalf()) - Moments(UpperHalf(), M_PI / 2)).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_GT((Moments(RightHalf()) - Moments(UpperHalf())).cwiseAbs().maxCoeff(), 0.1);
}

TEST(ZernikeMomentsTest, ChangeSignsIfRightAndLeftAreExchanged) {
  // Slanted, so that sines do not vanish.
  const Silhouette slanted = Rows([](double y) {
    return y > -0.2 && y < 0.5 ? std::pair(-0.6 + y, 0.2 + y) : std::pair(0.0, 0.0);
  });
  Silhouette mirrored = slanted;
  for (Span& span : mirrored.spans) span = {span.y, -span.end, -span.begin};
  const Eigen::VectorXd signs = ZernikeMoments(kOrder).MirrorSigns();
  EXPECT_TRUE(signs.cwiseProduct(Moments(slanted)).isApprox(Moments(mirrored), 1e-9));
  EXPECT_GT((Moments(slanted) - Moments(mirrored)).norm(), 0.1);
}

TEST(ZernikeMomentsTest, IgnorePlaceAndSizeWithTheDisc) {
  const Silhouette one = Ellipse(0.9, 0.4);
  Silhouette other = one;
  for (Span& span : other.spans) {
    span = {5 * span.y + 3, 5 * span.begin - 8, 5 * span.end - 8};
  }
  other.row_height *= 5;
  EXPECT_TRUE(Moments(one).isApprox(ZernikeMoments(kOrder).Of(other, {-8, 3}, 5, 0), 1e-9));
}

}  // namespace
}  // namespace mortise::retrieval
