// Grids: heights by the formula, slopes, extremes, holes and borders, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/base/violation_lists.h"
#include "tests/unit/common/terrain/sampled_extremes.h"

namespace mortise::terrain {
namespace {

using ::testing::HasSubstr;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Field = std::shared_ptr<const HeightField>;

HeightGrid Grid(const Eigen::MatrixXd& heights, const Eigen::Vector2d& origin = {0, 0},
                const Eigen::Vector2d& spacing = {1, 1}) {
  return {origin, spacing, heights};
}

// Random heights, 7 x 5, half a metre and 0.4 m apart.
Field RandomGrid(std::mt19937& random) {
  std::uniform_real_distribution<double> height(-0.3, 0.3);
  const Eigen::MatrixXd heights =
      Eigen::MatrixXd::NullaryExpr(7, 5, [&] { return height(random); });
  return HeightField::Create(Grid(heights, {0, 0}, {0.5, 0.4})).value();
}

TEST(GridHeights, FollowAPlaneExactly) {
  Eigen::MatrixXd heights(4, 3);
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) heights(i, k) = 1 + 0.2 * (2 + 0.5 * i) - 0.1 * (3 + 0.25 * k);
  }
  ASSERT_OK_AND_ASSIGN(const Field field, HeightField::Create(Grid(heights, {2, 3}, {0.5, 0.25})));
  for (const auto& [x, y] : {std::pair(2.0, 3.0), {3.5, 3.5}, {2.61, 3.17}, {2.5, 3.25}}) {
    ASSERT_OK_AND_ASSIGN(const PlaceValue height, field->HeightAt(x, y));
    EXPECT_NEAR(height.value, 1 + 0.2 * x - 0.1 * y, 1e-12);
    EXPECT_NEAR(height.gradient.x(), 0.2, 1e-12);
    EXPECT_NEAR(height.gradient.y(), -0.1, 1e-12);
    ASSERT_OK_AND_ASSIGN(const PlaceValue slope, field->SlopeAt(x, y));
    EXPECT_NEAR(slope.value, std::hypot(0.2, 0.1), 1e-12);
    EXPECT_NEAR(slope.gradient.norm(), 0, 1e-12);
  }
  ASSERT_OK_AND_ASSIGN(const RectangleValue lowest, field->LowestUnder({2.1, 2.9, 3.1, 3.4}));
  EXPECT_NEAR(lowest.value, 1 + 0.2 * 2.1 - 0.1 * 3.4, 1e-12);
  EXPECT_NEAR((lowest.gradient - Eigen::Vector4d(0.2, 0, 0, -0.1)).norm(), 0, 1e-12);
  ASSERT_OK_AND_ASSIGN(const RectangleValue highest, field->HighestUnder({2.1, 2.9, 3.1, 3.4}));
  EXPECT_NEAR((highest.gradient - Eigen::Vector4d(0, 0.2, -0.1, 0)).norm(), 0, 1e-12);
}

TEST(GridHeights, AreBilinearInACell) {
  const Field field = HeightField::Create(Grid(Eigen::Matrix2d{{1, 2}, {4, 9}})).value();
  const double x = 0.3, y = 0.8;
  EXPECT_NEAR(field->HeightAt(x, y)->value,
              1 * (1 - x) * (1 - y) + 4 * x * (1 - y) + 2 * (1 - x) * y + 9 * x * y, 1e-12);
}

TEST(GridHeights, HaveTheExtremesAndDerivativesThatSamplesShow) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.01, 0.99);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    const Field field = RandomGrid(random);
    ExpectExtremes(*field, 3, 1.6, 3, random);
    const double x = 3 * share(random), y = 1.6 * share(random);
    ExpectPlaceGradient([&](double a, double b) { return field->HeightAt(a, b); }, x, y);
    ExpectPlaceGradient([&](double a, double b) { return field->SlopeAt(a, b); }, x, y);
  }
}

TEST(GridHeights, AreAlsoKnownUnderLinesAndPoints) {
  std::mt19937 random(3);
  const Field field = RandomGrid(random);
  ASSERT_OK_AND_ASSIGN(const RectangleValue point, field->HighestUnder({0.5, 0.5, 0.8, 0.8}));
  EXPECT_NEAR(point.value, field->HeightAt(0.5, 0.8)->value, 1e-12);
  const Rectangle line = {0.2, 2.7, 0.4, 0.4};
  const Extremes sampled = SampledUnder(*field, line);
  EXPECT_NEAR(field->LowestUnder(line)->value, sampled.lowest, 0.1);
  EXPECT_LE(field->LowestUnder(line)->value, sampled.lowest + 1e-12);
}

TEST(GridHeights, EndAtTheirBorder) {
  const Field field = HeightField::Create(Grid(Eigen::MatrixXd::Zero(4, 3))).value();
  EXPECT_OK(field->HeightAt(3 + 1e-10, 2));
  EXPECT_OK(field->LowestUnder({-1e-10, 3, 0, 2 + 1e-10}));
  const absl::Status outside = field->HeightAt(3.2, 1).status();
  EXPECT_TRUE(absl::IsOutOfRange(outside));
  EXPECT_EQ(outside.message(), "is known for x 0 to 3 m and y 0 to 2 m, not at x = 3.2 m, y = 1 m");
  const absl::Status beyond = field->LowestUnder({1, 3.5, 0, 1}).status();
  EXPECT_TRUE(absl::IsOutOfRange(beyond));
  EXPECT_THAT(beyond.message(), HasSubstr("not under all of x 1 to 3.5 m, y 0 to 1 m"));
  EXPECT_TRUE(absl::IsInvalidArgument(field->LowestUnder({2, 1, 0, 1}).status()));
  EXPECT_FALSE(field->HeightAt(kUnknown, 1).ok());
}

TEST(GridHeights, TellOfHolesWhereTheyAre) {
  Eigen::MatrixXd heights = Eigen::MatrixXd::Constant(5, 5, 2);
  heights(2, 2) = kUnknown;
  const Field field = HeightField::Create(Grid(heights)).value();
  EXPECT_OK(field->HeightAt(0.5, 0.5));
  EXPECT_OK(field->HeightAt(1, 1.5)) << "the edge of a cell that is known";
  EXPECT_EQ(field->HeightAt(1.5, 1.25).status().message(), "has a hole at x = 1.5 m, y = 1.25 m");
  EXPECT_OK(field->LowestUnder({0, 1, 0, 4}));
  EXPECT_EQ(field->LowestUnder({0, 2, 0, 4}).status().message(),
            "has a hole at x = 1.5 m, y = 1.5 m");
}

TEST(GridHeights, NameAllThatIsWrong) {
  const auto faults = [](HeightGrid grid) {
    std::vector<std::string> fields;
    for (const FieldViolation& each :
         AllViolationsOf(HeightField::Create(std::move(grid)).status())) {
      fields.push_back(each.field);
    }
    return fields;
  };
  Eigen::MatrixXd heights = Eigen::MatrixXd::Zero(3, 2);
  heights(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(faults(Grid(heights, {kUnknown, 0}, {0, 1})),
              ::testing::ElementsAre("x", "x_spacing", "heights[4]"));
  EXPECT_THAT(faults(Grid(Eigen::MatrixXd::Zero(1, 5))), ::testing::ElementsAre("heights"));
  EXPECT_THAT(faults(Grid(Eigen::MatrixXd::Zero(1000, 101))), ::testing::ElementsAre("heights"));
  EXPECT_THAT(faults(Grid(Eigen::MatrixXd::Constant(3, 3, kUnknown))),
              ::testing::ElementsAre("heights"));
}

}  // namespace
}  // namespace mortise::terrain
