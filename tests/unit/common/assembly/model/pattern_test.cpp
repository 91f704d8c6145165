// Patterns: found largest first, and laid out anew without gaps, overlaps or lost parts.
#include "common/assembly/model/pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "common/assembly/model/element.h"
#include "common/assembly/model/linear_design.h"
#include "tests/unit/common/assembly/model/assemblies.h"

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

// At the drawn parameters every part is where it was drawn, and there are no others.
void ExpectDrawnAgain(const Assembly& assembly) {
  const std::vector<Element> elements = MakeElements(assembly, kTolerance);
  const auto placed = PlaceParts(assembly, elements, DrawnParameters(elements));
  ASSERT_EQ(placed.size(), assembly.parts.size());
  for (const PlacedPart& part : placed) {
    const auto drawn =
        std::find_if(assembly.parts.begin(), assembly.parts.end(),
                     [&](const AssemblyPart& other) { return other.name == part.name; });
    ASSERT_NE(drawn, assembly.parts.end()) << part.name;
    EXPECT_LT((drawn->box.minimum - part.box.minimum).norm(), 1e-9) << part.name;
    EXPECT_LT((drawn->box.maximum - part.box.maximum).norm(), 1e-9) << part.name;
  }
}

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
    Assembly rest = assembly;
    for (const int part : taken) rest.parts[static_cast<std::size_t>(part)].item = "items/taken";
    for (const FoundPattern& pattern : FindPatterns(rest, kTolerance)) {
      EXPECT_TRUE(taken.contains(pattern.parts.front())) << seed;
    }
    ExpectDrawnAgain(assembly);
  }
}

// Directions that share an axis would each fill all of the box.
TEST(PatternTest, AGridThatStandsAtAnAngleIsRows) {
  Assembly assembly = Parts();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) AddCube(assembly, {0.1 * (i + j), 0.1 * (i - j), 0}, 0.02);
  }
  for (const FoundPattern& found : FindPatterns(assembly, kTolerance)) {
    EXPECT_EQ(found.pattern.directions[1].count, 1);
  }
  ExpectDrawnAgain(assembly);
}

// The first part's limits, grain and planes would count for all.
TEST(PatternTest, PartsThatDifferInMoreThanPlaceAreNoPattern) {
  const std::vector<std::function<void(AssemblyPart&)>> differences = {
      [](AssemblyPart& part) { std::swap(part.item_axes[0], part.item_axes[1]); },
      [](AssemblyPart& part) { part.limits[1].maximum *= 2; },
      [](AssemblyPart& part) { part.color = Eigen::Vector3d(1, 0, 0); },
      [](AssemblyPart& part) {
        part.prominent_planes = {{"edge", Axis::kZ, 0.01}};
      },
  };
  for (const auto& difference : differences) {
    Assembly assembly = Parts();
    for (int i = 0; i < 3; ++i) AddCube(assembly, {0.1 * i, 0, 0});
    EXPECT_EQ(FindPatterns(assembly, kTolerance).size(), 1U);
    difference(assembly.parts[1]);
    EXPECT_TRUE(FindPatterns(assembly, kTolerance).empty());
  }
}

TEST(PatternTest, KeepsThePlanesThatAllPartsHave) {
  Assembly assembly = Parts();
  for (int i = 0; i < 3; ++i) {
    AddCube(assembly, {0.1 * i, 0, 0});
    assembly.parts.back().prominent_planes = {{"shoulder", Axis::kZ, 0.01},
                                              {"side", Axis::kX, 0.1 * i + 0.02}};
  }
  const std::vector<Element> elements = MakeElements(assembly, kTolerance);
  ASSERT_EQ(elements.size(), 1U);
  ASSERT_EQ(elements[0].planes.size(), 7U) << "along the row each part has its own";
  EXPECT_EQ(elements[0].planes[6].name, "shoulder");
  EXPECT_NEAR(PositionOf(0, elements[0].planes[6]).At(DrawnParameters(elements)), 0.01, 1e-12);
}

// With another number of slats one would stand where the post does.
TEST(PatternTest, NothingStandsBetweenThePartsUnlessItTouchesThemAll) {
  Assembly assembly = Parts();
  for (int i = 0; i < 6; ++i) AddCube(assembly, {0.2 * i, 0, 0});
  AddCube(assembly, {0.3, 0, 0}, 0.03);
  const auto between = FindPatterns(assembly, kTolerance);
  ASSERT_EQ(between.size(), 1U);
  EXPECT_EQ(between[0].parts, (std::vector<int>{2, 3, 4, 5}));
  AddCube(assembly, {0.7, 0.2, 0}, 0.03);  // beside the row
  EXPECT_EQ(FindPatterns(assembly, kTolerance)[0].parts.size(), 4U);
  assembly.parts.push_back(FixedPart("rail", {0, -0.04, -0.01}, {1.2, 0, 0.01}));  // through all
  EXPECT_EQ(FindPatterns(assembly, kTolerance)[0].parts.size(), 4U);
  AddCube(assembly, {0.9, 0, 0}, 0.15);  // touches the last two of these
  EXPECT_EQ(FindPatterns(assembly, kTolerance)[0].parts, (std::vector<int>{2, 3, 4}));
}

// A drawing that is out by less than its tolerance has no direction of its own.
TEST(PatternTest, RoundingIsNoDirection) {
  Assembly assembly = Parts();
  for (int i = 0; i < 4; ++i) AddCube(assembly, {0.1 * i, 1e-8 * i, 0});
  const std::vector<Element> elements = MakeElements(assembly, kTolerance);
  ASSERT_EQ(elements.size(), 1U);
  EXPECT_EQ(elements[0].pattern->directions[0].spacing.y(), 0);
  EXPECT_EQ(elements[0].limits[1].minimum, elements[0].limits[1].maximum);
}

// A thousand in a row, and a field of forty by fifty: what an import may have.
TEST(PatternTest, ManyPartsAreFoundAtOnce) {
  Assembly row = Parts();
  for (int i = 0; i < 1000; ++i) AddCube(row, {0.1 * i, 0, 0});
  const auto found = FindPatterns(row, kTolerance);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parts.size(), 1000U);
}

TEST(LayOutTest, PartsStayWithinWhatTheirItemAllows) {
  // Boards of 2.4 m end to end, which come up to 2.44 m long.
  Pattern pattern = Row(3, 2.4, 2.4, false, true);
  pattern.part_limits[0] = {0.04, 2.44};
  const SizeLimits lengths = LengthsOf(pattern, 0, 7.2, kTolerance);
  EXPECT_NEAR(lengths.minimum, 3.6, 1e-9);
  EXPECT_NEAR(lengths.maximum, 14.4, 1e-9);
  for (double length = lengths.minimum; length <= lengths.maximum; length += 0.0173) {
    const PatternLayout layout = LayOut(pattern, BoxOfLength(length));
    EXPECT_LE(layout.part_size.x(), 2.44 + 1e-9) << length;
    EXPECT_NEAR(layout.part_size.x() * layout.directions[0].count, length, 1e-9);
  }
  EXPECT_EQ(LayOut(pattern, BoxOfLength(8.2)).directions[0].count, 4);
}

TEST(LayOutTest, LengthsThatNoNumberOfPartsFillsAreNotOffered) {
  // Parts of 0.95 m to 1.05 m: three are up to 3.15 m long, four at least 3.8 m.
  Pattern pattern = Row(3, 1, 1, false, true);
  pattern.part_limits[0] = {0.95, 1.05};
  const SizeLimits lengths = LengthsOf(pattern, 0, 3, kTolerance);
  EXPECT_NEAR(lengths.minimum, 2.85, 1e-9);
  EXPECT_NEAR(lengths.maximum, 3.15, 1e-9);
  for (const double length : {2.85, 2.9, 3.0, 3.15}) {
    EXPECT_EQ(LayOut(pattern, BoxOfLength(length)).directions[0].count, 3);
  }
  // Where parts overlap by a fifth: seven of 0.9 m and six of 1.05 m are both 5.25 m long.
  pattern = Row(6, 0.8, 1, false, true);
  pattern.part_limits[0] = {0.9, 1.05};
  const SizeLimits joined = LengthsOf(pattern, 0, 5, kTolerance);
  for (double length = joined.minimum; length <= joined.maximum; length += 0.01) {
    const double part = LayOut(pattern, BoxOfLength(length)).part_size.x();
    EXPECT_GE(part, 0.9 - 1e-9) << length;
    EXPECT_LE(part, 1.05 + 1e-9) << length;
  }
  EXPECT_GT(joined.maximum, 6 * 0.8 * 1.05 + 0.3);
}

TEST(LayOutTest, PartsOfOneSizeThatTouchCannotComeApart) {
  const Pattern boards = Row(5, 0.1, 0.1, false, false);
  const SizeLimits lengths = LengthsOf(boards, 0, 0.5, kTolerance);
  EXPECT_EQ(lengths.minimum, 0.5);
  EXPECT_EQ(lengths.maximum, 0.5);
  EXPECT_EQ(LengthsOf(Row(5, 0.1, 0.1, false, true), 0, 0.5, kTolerance).maximum, 1.0);
  EXPECT_EQ(LengthsOf(Row(5, 0.12, 0.1, false, false), 0, 0.58, kTolerance).maximum, 1.16);
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
