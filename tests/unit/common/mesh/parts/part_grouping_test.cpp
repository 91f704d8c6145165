#include "common/mesh/parts/part_grouping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "common/base/errors.h"
#include "tests/support/box_scenes.h"

namespace mortise::mesh {
namespace {

using testing::Box;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::OneComponent;
using testing::OpenBox;
using testing::TableParts;

std::vector<SurfacePiece> Pieces(const std::vector<SceneComponent>& components) {
  Scene scene;
  scene.components = components;
  return PiecesOf(scene);
}

PartGrouping Grouped(const std::vector<SceneComponent>& components,
                     const PartGroupingOptions& options = {}) {
  const auto grouping = GroupPieces(Pieces(components), options);
  EXPECT_TRUE(grouping.ok()) << grouping.status();
  return grouping.value_or(PartGrouping());
}

TEST(GroupPieces, MakesAPartOfEachPiece) {
  const PartGrouping grouping = Grouped(TableParts());
  EXPECT_THAT(grouping.part_of, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(grouping.count, 5);
  EXPECT_THAT(grouping.has_gap, ::testing::Each(false));
  EXPECT_THAT(grouping.notes, IsEmpty());
}

TEST(GroupPieces, TakesWhatIsDrawnTwiceOnce) {
  std::vector<SceneComponent> parts = TableParts();
  parts.push_back(parts[0]);
  parts.back().triangles.row(1).swap(parts.back().triangles.row(2));  // seen from inside
  const PartGrouping grouping = Grouped(parts);
  EXPECT_THAT(grouping.part_of, ElementsAre(0, 1, 2, 3, 4, -1));
  EXPECT_THAT(grouping.notes, ElementsAre(HasSubstr("1 piece drawn twice")));
}

TEST(GroupPieces, MakesDecalsPartOfWhatTheyLieOn) {
  std::vector<SceneComponent> parts = TableParts();
  SceneComponent decal = Box("", {0.3, 0.2, 0.74}, {0.4, 0.3, 0});
  decal.triangles = decal.triangles.leftCols(12).rightCols(2).eval();
  parts.push_back(decal);
  const PartGrouping grouping = Grouped(parts);
  EXPECT_THAT(grouping.part_of, ElementsAre(0, 1, 2, 3, 4, 0));
}

TEST(GroupPieces, JoinsWhatTouchesNothingWithWhatIsNearest) {
  std::vector<SceneComponent> parts = TableParts();
  parts.push_back(Box("", {0.5, 0.3, 0.8}, {0.1, 0.1, 0.1}));  // 6 cm above the top
  parts.push_back(Box("", {0.5, 0.3, 0.9}, {0.1, 0.1, 0.1}));  // upon that
  const PartGrouping grouping = Grouped(parts);
  EXPECT_THAT(grouping.part_of, ElementsAre(0, 1, 2, 3, 4, 0, 5));
  EXPECT_THAT(grouping.notes, ElementsAre(HasSubstr("1 piece touches nothing")));
}

TEST(GroupPieces, TakesWhatNearlyTouchesForTouching) {
  std::vector<SceneComponent> parts = TableParts();
  parts.push_back(Box("", {0.5, 0.3, 0.7405}, {0.1, 0.1, 0.1}));  // half a millimetre above
  const PartGrouping grouping = Grouped(parts);
  EXPECT_EQ(grouping.count, 6);
  EXPECT_THAT(grouping.has_gap, ElementsAre(true, false, false, false, false, true));
}

// All four feet go, not the one that would do.
TEST(GroupPieces, JoinsTheSmallestWhereThereAreTooMany) {
  std::vector<SceneComponent> parts = TableParts();
  for (int leg = 1; leg <= 4; ++leg) {
    const Eigen::Vector3d low = parts[static_cast<std::size_t>(leg)].vertices.rowwise().minCoeff();
    parts.push_back(Box("", low - Eigen::Vector3d(0, 0, 0.01), {0.05, 0.05, 0.01}));
  }
  const PartGrouping grouping = Grouped(parts, {.most_parts = 8});
  EXPECT_THAT(grouping.part_of, ElementsAre(0, 1, 2, 3, 4, 1, 2, 3, 4));
  EXPECT_THAT(grouping.notes, ElementsAre(HasSubstr("more than 8 parts")));
  EXPECT_EQ(Grouped(parts, {.most_parts = 1}).count, 1);
}

TEST(GroupPieces, KeepsComponentsTogetherWhereTheyHaveNames) {
  std::vector<SceneComponent> parts = TableParts();
  // A block of the top's component that lies in a leg's box.
  SceneComponent block = Box("", {0.03, 0.03, 0.69}, {0.01, 0.01, 0.02});
  parts[0] = OneComponent({parts[0], block}).components[0];
  const auto pieces = Pieces(parts);
  const auto apart = GroupPieces(pieces, {.most_parts = 5});
  const auto kept = GroupPieces(pieces, {.most_parts = 5, .keeps_components = true});
  ASSERT_TRUE(apart.ok() && kept.ok());
  EXPECT_THAT(kept->part_of, ElementsAre(0, 0, 1, 2, 3, 4));
  EXPECT_EQ(kept->count, 5);
  EXPECT_EQ(apart->count, 5);
}

// More pieces than are looked at one by one, which is far from the limit on parts.
TEST(GroupPieces, TakesManyPieces) {
  std::vector<SceneComponent> parts = TableParts();
  for (int i = 0; i < 700; ++i) {
    parts.push_back(Box("", {0.01 + 0.03 * (i % 35), 0.01 + 0.03 * (i / 35), 0.74},
                        {0.01, 0.01, 0.01 + 1e-5 * i}));
  }
  const PartGrouping grouping = Grouped(parts, {.most_parts = 40});
  EXPECT_LE(grouping.count, 40);
  EXPECT_GE(grouping.count, 5);
  EXPECT_THAT(grouping.part_of, ::testing::Each(::testing::Ge(0)));
}

TEST(GroupPieces, RefusesPiecesWithoutTriangles) {
  const auto grouping = GroupPieces({SurfacePiece()});
  EXPECT_EQ(DetailOf(grouping.status()).field, "pieces[0]");
}

TEST(AreAlike, ComparesCornersWhateverTheirOrder) {
  const SceneComponent box = Box("", {0, 0, 0}, {1, 2, 3});
  const SceneComponent moved = testing::Moved(box, {5, 0, 0});
  SurfaceMesh a{box.vertices, box.triangles};
  SurfaceMesh b{moved.vertices.rowwise().reverse(), moved.triangles};
  EXPECT_TRUE(AreAlike(a, b, {-5, 0, 0}, 1e-6));
  EXPECT_FALSE(AreAlike(a, b, {-5.1, 0, 0}, 1e-6));
  b.vertices(2, 0) += 0.01;
  EXPECT_FALSE(AreAlike(a, b, {-5, 0, 0}, 1e-6));
}

}  // namespace
}  // namespace mortise::mesh
