// Triangles: planes, extremes, holes between them and borders, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/base/violation_lists.h"
#include "tests/unit/common/terrain/sampled_extremes.h"

namespace mortise::terrain {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Field = std::shared_ptr<const HeightField>;

// Squares of two triangles each over a grid of `count` squares a side, whose inner corners are
// moved about; heights are those of `height_at`.
template <typename HeightAt>
HeightTriangles Patchwork(int count, std::mt19937& random, HeightAt height_at) {
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  HeightTriangles patches;
  const int lines = count + 1;
  patches.vertices.resize(3, lines * lines);
  for (int i = 0; i < lines * lines; ++i) {
    double x = i % lines, y = i / lines;
    if (x > 0 && x < count && y > 0 && y < count) {
      x += shift(random);
      y += shift(random);
    }
    patches.vertices.col(i) << x, y, height_at(x, y);
  }
  patches.triangles.resize(3, 2 * count * count);
  for (int i = 0; i < count * count; ++i) {
    const int corner = i / count * lines + i % count;
    patches.triangles.col(2 * i) << corner, corner + 1, corner + lines;
    // In the other direction, as scans have them.
    patches.triangles.col(2 * i + 1) << corner + 1, corner + lines, corner + lines + 1;
  }
  return patches;
}

TEST(TriangleHeights, FollowAPlaneExactly) {
  std::mt19937 random(1);
  const auto plane = [](double x, double y) { return 4 - 0.3 * x + 0.25 * y; };
  const Field field = HeightField::Create(Patchwork(4, random, plane)).value();
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {4.0, 4.0}, {1.37, 2.91}, {3.0, 0.0}}) {
    ASSERT_OK_AND_ASSIGN(const PlaceValue height, field->HeightAt(x, y));
    EXPECT_NEAR(height.value, plane(x, y), 1e-12);
    EXPECT_NEAR(height.gradient.x(), -0.3, 1e-12);
    EXPECT_NEAR(field->SlopeAt(x, y)->value, std::hypot(0.3, 0.25), 1e-12);
  }
  // Also where edges run along the rectangle's sides.
  for (const Rectangle& rectangle : {Rectangle{0, 4, 0, 4}, {0.2, 3.1, 0, 2.4}, {0, 1, 1.5, 4}}) {
    ASSERT_OK_AND_ASSIGN(const RectangleValue lowest, field->LowestUnder(rectangle));
    EXPECT_NEAR(lowest.value, plane(rectangle.to_x, rectangle.from_y), 1e-12);
    EXPECT_NEAR((lowest.gradient - Eigen::Vector4d(0, -0.3, 0.25, 0)).norm(), 0, 1e-9);
  }
}

TEST(TriangleHeights, HaveTheExtremesAndDerivativesThatSamplesShow) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> height(-0.3, 0.3), share(0.01, 0.99);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    const Field field = HeightField::Create(Patchwork(4, random, [&](double, double) {
                          return height(random);
                        })).value();
    ExpectExtremes(*field, 4, 4, 4, random);
    const double x = 4 * share(random), y = 4 * share(random);
    ExpectPlaceGradient([&](double a, double b) { return field->HeightAt(a, b); }, x, y);
  }
}

TEST(TriangleHeights, AreAlsoKnownUnderLinesAndPoints) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> height(-0.3, 0.3);
  const Field field = HeightField::Create(Patchwork(4, random, [&](double, double) {
                        return height(random);
                      })).value();
  for (const Rectangle& line : {Rectangle{0.3, 3.6, 1.7, 1.7}, {2.2, 2.2, 0.4, 3.9}}) {
    const Extremes sampled = SampledUnder(*field, line);
    ASSERT_OK_AND_ASSIGN(const RectangleValue lowest, field->LowestUnder(line));
    EXPECT_LE(lowest.value, sampled.lowest + 1e-9);
    EXPECT_NEAR(lowest.value, sampled.lowest, 0.05);
    ASSERT_OK_AND_ASSIGN(const RectangleValue highest, field->HighestUnder(line));
    EXPECT_NEAR(highest.value, sampled.highest, 0.05);
    // As it moves sideways.
    constexpr double kStep = 1e-6;
    const bool is_across = line.from_y == line.to_y;
    Rectangle moved = line;
    (is_across ? moved.from_y : moved.from_x) += kStep;
    (is_across ? moved.to_y : moved.to_x) += kStep;
    EXPECT_NEAR((field->LowestUnder(moved)->value - lowest.value) / kStep,
                lowest.gradient(is_across ? 2 : 0), 1e-3);
  }
  EXPECT_NEAR(field->HighestUnder({1.2, 1.2, 2.3, 2.3})->value, field->HeightAt(1.2, 2.3)->value,
              1e-12);
}

TEST(TriangleHeights, TellOfHolesAndBorders) {
  std::mt19937 random(2);
  HeightTriangles patches = Patchwork(4, random, [](double, double) { return 1.0; });
  Eigen::Matrix3Xi without(3, patches.triangles.cols() - 2);
  without << patches.triangles.leftCols(10), patches.triangles.rightCols(20);  // square (1, 1)
  patches.triangles = without;
  const Field field = HeightField::Create(std::move(patches)).value();
  EXPECT_OK(field->HeightAt(0.2, 0.3));
  EXPECT_OK(field->HeightAt(4 + 1e-10, 2));
  EXPECT_EQ(field->HeightAt(1.5, 1.5).status().message(), "has a hole at x = 1.5 m, y = 1.5 m");
  EXPECT_THAT(field->HeightAt(4.5, 1).status().message(),
              HasSubstr("is known for x 0 to 4 m and y 0 to 4 m, not at x = 4.5 m"));
  EXPECT_OK(field->LowestUnder({0, 4, 3.4, 4}));
  EXPECT_THAT(field->LowestUnder({0, 4, 0, 4}).status().message(),
              HasSubstr("has a hole at x = 1"));
  EXPECT_THAT(field->LowestUnder({0, 4, 1.5, 1.5}).status().message(),
              HasSubstr("has a hole at x = "));
  EXPECT_TRUE(absl::IsOutOfRange(field->LowestUnder({3, 5, 3, 3.5}).status()));
}

TEST(TriangleHeights, NameAllThatIsWrong) {
  const auto faults = [](HeightTriangles triangles) {
    std::vector<std::string> told;
    for (const FieldViolation& each :
         AllViolationsOf(HeightField::Create(std::move(triangles)).status())) {
      told.push_back(each.field + ": " + each.message);
    }
    return told;
  };
  HeightTriangles two;
  two.vertices.resize(3, 4);
  two.vertices << 0, 1, 0, 1,  //
      0, 0, 1, 1,              //
      0, 0, 0, 0;
  two.triangles.resize(3, 2);
  two.triangles << 0, 1,  //
      1, 3,               //
      2, 2;
  EXPECT_OK(HeightField::Create(two));
  HeightTriangles broken = two;
  broken.triangles(1, 1) = 7;
  broken.vertices(2, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(faults(broken), ElementsAre(HasSubstr("vertices[2]: must be within"),
                                          "triangles[4]: there is no vertex 7; there are 4"));
  HeightTriangles flat = two;
  flat.triangles.col(1) << 1, 1, 2;
  EXPECT_THAT(faults(flat), ElementsAre(HasSubstr("triangles[3]: triangle 1 has no area")));
  HeightTriangles folded = two;
  folded.triangles.col(1) << 0, 1, 3;
  EXPECT_THAT(faults(folded),
              ElementsAre(HasSubstr("triangles[3]: triangle 1 lies over triangle 0")));
  EXPECT_THAT(faults({}), ElementsAre(HasSubstr("vertices: are 0")));
}

}  // namespace
}  // namespace mortise::terrain
