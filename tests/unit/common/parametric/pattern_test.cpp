// Patterns: found largest first, and laid out anew without gaps, overlaps or lost parts.
#include "common/parametric/pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/unit/common/parametric/assemblies.h"

namespace mortise::parametric {
namespace {

constexpr double kTolerance = 1e-6;

Assembly Parts() {
  Assembly assembly;
  assembly.name = "parts";
  assembly.groups = {{"root", -1}};
  return assembly;
}

void AddCube(Assembly& assembly, const Eigen::Vector3d& center, double side = 0.05) {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(side / 2);
  assembly.parts.push_back(
      FixedPart("part " + std::to_string(assembly.parts.size()), center - half, center + half));
}

Pattern Row(int count, double spacing, double size, bool connecting, bool resizable) {
  Pattern pattern;
  pattern.directions[0] = {count, {spacing, 0, 0}};
  pattern.part_size = {size, 0.2, 0.02};
  pattern.connecting = connecting;
  pattern.resizable = {resizable, true, false};
  return pattern;
}

BoundingBox BoxOfLength(double length) { return {{1, 0, 0}, {1 + length, 0.3, 0.02}}; }

TEST(PatternTest, FindsARow) {
  Assembly assembly = Parts();
  for (int i = 0; i < 5; ++i) AddCube(assembly, {0.1 * i, 0, 0});
  const auto found = FindPatterns(assembly, kTolerance);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parts, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(found[0].pattern.directions[0].count, 5);
  EXPECT_NEAR((found[0].pattern.directions[0].spacing - Eigen::Vector3d(0.1, 0, 0)).norm(), 0,
              1e-9);
  EXPECT_EQ(found[0].pattern.directions[1].count, 1);
}

TEST(PatternTest, FindsAGridBeforeItsRows) {
  Assembly assembly = Parts();
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 4; ++i) AddCube(assembly, {0.1 * i, 0.2 * j, 0});
  }
  AddCube(assembly, {0.4, 0, 0});  // makes the first row longer than the others
  const auto found = FindPatterns(assembly, kTolerance);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parts.size(), 12U);
  const std::set<int> counts = {found[0].pattern.directions[0].count,
                                found[0].pattern.directions[1].count};
  EXPECT_EQ(counts, (std::set<int>{3, 4}));
}

TEST(PatternTest, FindsSlopingRows) {
  Assembly assembly = Parts();
  for (int i = 0; i < 6; ++i) AddCube(assembly, {0.25 * i, 0, 0.18 * i});
  const auto found = FindPatterns(assembly, kTolerance);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR((found[0].pattern.directions[0].spacing - Eigen::Vector3d(0.25, 0, 0.18)).norm(), 0,
              1e-9);
}

TEST(PatternTest, TwoPartsFourLegsAndStrangersAreNoPattern) {
  Assembly assembly = Parts();
  AddCube(assembly, {0, 0, 0});
  AddCube(assembly, {1, 0, 0});
  AddCube(assembly, {0, 1, 0});
  AddCube(assembly, {1, 1, 0});
  EXPECT_TRUE(FindPatterns(assembly, kTolerance).empty());
  AddCube(assembly, {2, 0, 0}, 0.06);  // in line, but of another size
  EXPECT_TRUE(FindPatterns(assembly, kTolerance).empty());
  AddCube(assembly, {2, 0, 0});
  assembly.parts.back().item = "items/other";
  EXPECT_TRUE(FindPatterns(assembly, kTolerance).empty());
  assembly.groups.push_back({"child", 0});
  AddCube(assembly, {2, 0, 0});
  assembly.parts.back().group = 1;
  EXPECT_TRUE(FindPatterns(assembly, kTolerance).empty());
}

// Largest first, no part twice, every pattern regular; nothing regular is left over.
TEST(PatternTest, RandomPlacesGiveDisjointRegularPatterns) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    Assembly assembly = Parts();
    std::set<std::array<int, 2>> places;
    while (places.size() < 25) {
      places.insert({static_cast<int>(random() % 9), static_cast<int>(random() % 9)});
    }
    for (const auto& [x, y] : places) AddCube(assembly, {0.1 * x, 0.1 * y, 0});
    const auto found = FindPatterns(assembly, kTolerance);
    std::set<int> taken;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i > 0) {
        EXPECT_LE(found[i].parts.size(), found[i - 1].parts.size());
      }
      const Pattern& pattern = found[i].pattern;
      const Eigen::Vector3d first =
          assembly.parts[static_cast<std::size_t>(found[i].parts[0])].box.center();
      for (std::size_t k = 0; k < found[i].parts.size(); ++k) {
        EXPECT_TRUE(taken.insert(found[i].parts[k]).second);
        const int along = static_cast<int>(k) % pattern.directions[0].count;
        const int across = static_cast<int>(k) / pattern.directions[0].count;
        const Eigen::Vector3d expected =
            first + along * pattern.directions[0].spacing + across * pattern.directions[1].spacing;
        const auto& part = assembly.parts[static_cast<std::size_t>(found[i].parts[k])];
        EXPECT_NEAR((part.box.center() - expected).norm(), 0, 1e-6);
      }
    }
    Assembly rest = Parts();
    for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
      if (!taken.contains(static_cast<int>(i))) rest.parts.push_back(assembly.parts[i]);
    }
    EXPECT_TRUE(FindPatterns(rest, kTolerance).empty()) << seed;
  }
}

TEST(LayOutTest, TheDrawnBoxGivesTheDrawnPattern) {
  for (const bool resizable : {false, true}) {
    const PatternLayout layout = LayOut(Row(5, 0.1, 0.06, false, resizable), BoxOfLength(0.46));
    EXPECT_EQ(layout.directions[0].count, 5);
    EXPECT_NEAR(layout.directions[0].spacing.x(), 0.1, 1e-12);
    EXPECT_NEAR(layout.part_size.x(), 0.06, 1e-12);
    EXPECT_NEAR(layout.part_size.y(), 0.3, 1e-12);  // across the pattern a part fills the box
    EXPECT_NEAR(layout.first_center.x(), 1.03, 1e-12);
  }
}

TEST(LayOutTest, ThePartsFillTheBoxFromEndToEndWithoutIntersecting) {
  for (const bool connecting : {false, true}) {
    for (const bool resizable : {false, true}) {
      const Pattern pattern = Row(5, 0.1, 0.06, connecting, resizable);
      for (double length = 0.13; length < 2; length += 0.0137) {
        const BoundingBox box = BoxOfLength(length);
        const PatternLayout layout = LayOut(pattern, box);
        const int count = layout.directions[0].count;
        const double half = layout.part_size.x() / 2;
        EXPECT_NEAR(layout.CenterOf(0).x() - half, box.minimum.x(), 1e-9);
        EXPECT_NEAR(layout.CenterOf(count - 1).x() + half, box.maximum.x(), 1e-9);
        EXPECT_GE(layout.directions[0].spacing.x(), layout.part_size.x() - 1e-9);
        EXPECT_GE(count, 2);
      }
    }
  }
}

// No other count comes nearer to the drawn spacing.
TEST(LayOutTest, APrincipalPatternTakesTheNearestCount) {
  for (double length = 0.2; length < 2; length += 0.0173) {
    const PatternLayout layout = LayOut(Row(5, 0.1, 0.02, false, false), BoxOfLength(length));
    const double error = std::abs(layout.directions[0].spacing.x() - 0.1);
    for (int count = 2; count < 40; ++count) {
      EXPECT_LE(error, std::abs((length - 0.02) / (count - 1) - 0.1) + 1e-9) << length;
    }
  }
}

TEST(LayOutTest, AConnectingPatternIsNeverSparserThanDrawn) {
  for (double length = 0.2; length < 2; length += 0.0173) {
    const PatternLayout layout = LayOut(Row(5, 0.1, 0.02, true, false), BoxOfLength(length));
    EXPECT_LE(layout.directions[0].spacing.x(), 0.1 + 1e-9);
    const int count = layout.directions[0].count;
    if (count > 2) {
      EXPECT_GT((length - 0.02) / (count - 2), 0.1);  // and no denser than need be
    }
  }
}

TEST(LayOutTest, AConnectingPatternGivesUpDensityBeforeItIntersects) {
  // Spacing .1, parts of .095: any closer spacing than .095 would intersect.
  const PatternLayout layout = LayOut(Row(3, 0.1, 0.095, true, false), BoxOfLength(0.335));
  EXPECT_EQ(layout.directions[0].count, 3);
  EXPECT_NEAR(layout.directions[0].spacing.x(), 0.12, 1e-9);
}

TEST(LayOutTest, ResizablePartsScaleWithTheSpacing) {
  const PatternLayout layout = LayOut(Row(5, 0.1, 0.06, false, true), BoxOfLength(0.51));
  EXPECT_NEAR(layout.part_size.x() / layout.directions[0].spacing.x(), 0.6, 1e-9);
}

TEST(LayOutTest, AGridChangesBothCounts) {
  Pattern pattern = Row(4, 0.1, 0.02, false, false);
  pattern.directions[1] = {3, {0, 0.2, 0}};
  pattern.part_size = {0.02, 0.02, 0.02};
  const PatternLayout layout = LayOut(pattern, {{0, 0, 0}, {0.62, 0.82, 0.02}});
  EXPECT_EQ(layout.directions[0].count, 7);
  EXPECT_EQ(layout.directions[1].count, 5);
  EXPECT_EQ(layout.part_count(), 35);
  EXPECT_NEAR((layout.CenterOf(34) - Eigen::Vector3d(0.61, 0.81, 0.01)).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace mortise::parametric
