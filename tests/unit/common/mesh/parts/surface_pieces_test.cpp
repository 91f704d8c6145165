#include "common/mesh/parts/surface_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/box_scenes.h"

namespace mortise::mesh {
namespace {

using testing::Box;
using testing::OneComponent;
using testing::OpenBox;

std::vector<Eigen::Index> Sizes(const std::vector<SurfacePiece>& pieces) {
  std::vector<Eigen::Index> sizes;
  for (const SurfacePiece& piece : pieces) sizes.push_back(piece.surface.triangles.cols());
  return sizes;
}

TEST(PiecesOf, TakesApartWhatDoesNotHangTogether) {
  const auto pieces =
      PiecesOf(OneComponent({Box("", {0, 0, 0}, {1, 1, 1}), OpenBox("", {3, 0, 0}, {1, 1, 1})}));
  EXPECT_THAT(Sizes(pieces), ::testing::ElementsAre(12, 10));
  EXPECT_TRUE(pieces[0].is_closed);
  EXPECT_FALSE(pieces[1].is_closed);
  EXPECT_EQ(pieces[1].surface.vertices.cols(), 8);
}

// Boxes that share a corner, or an edge.
TEST(PiecesOf, TakesClosedShellsApartWhereTheyTouch) {
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 1, 0)}) {
    const auto pieces =
        PiecesOf(OneComponent({Box("", {0, 0, 0}, {1, 1, 1}), Box("", at, {1, 1, 1})}));
    EXPECT_THAT(Sizes(pieces), ::testing::ElementsAre(12, 12)) << at.transpose();
  }
}

TEST(PiecesOf, KeepsOpenSurfacesThatShareCornersTogether) {
  const auto pieces =
      PiecesOf(OneComponent({OpenBox("", {0, 0, 0}, {1, 1, 1}), OpenBox("", {1, 1, 0}, {1, 1, 1}),
                             Box("", {-1, -1, -1}, {1, 1, 1})}));
  EXPECT_THAT(Sizes(pieces), ::testing::UnorderedElementsAre(20, 12));
}

// Each triangle of a sheet twice, to be seen from both sides: two that face each other enclose
// nothing.
TEST(PiecesOf, KeepsSheetsOfTwoSidesTogether) {
  const SceneComponent open = OpenBox("", {0, 0, 0}, {1, 1, 1});
  SceneComponent back = open;
  back.triangles.row(1).swap(back.triangles.row(2));
  const auto sheet = PiecesOf(OneComponent({open, back}));
  EXPECT_THAT(Sizes(sheet), ::testing::ElementsAre(20));
  EXPECT_FALSE(sheet[0].is_closed);
  // A box that touches it, drawn twice as well, is a piece by itself.
  const SceneComponent box = Box("", {1, 1, 0}, {1, 1, 1});
  const auto both = PiecesOf(OneComponent({open, back, box, box}));
  EXPECT_THAT(Sizes(both), ::testing::UnorderedElementsAre(20, 24));
}

TEST(PiecesOf, SaysWhichComponentAPieceIsOf) {
  Scene scene;
  scene.components = {Box("a", {0, 0, 0}, {1, 1, 1}), Box("b", {5, 0, 0}, {1, 1, 1})};
  const auto pieces = PiecesOf(scene);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].component, 0);
  EXPECT_EQ(pieces[1].component, 1);
}

// Each triangle has corners of its own, as STL has them, a little off.
TEST(PiecesOf, WeldsCornersThatNearlyMeet) {
  Scene scene = OneComponent({Box("", {0, 0, 0}, {1, 1, 1})});
  SceneComponent soup;
  const SceneComponent& box = scene.components[0];
  soup.vertices.resize(3, 36);
  soup.triangles.resize(3, 12);
  for (int i = 0; i < 36; ++i) {
    soup.vertices.col(i) = box.vertices.col(box.triangles.reshaped()(i));
    soup.vertices(0, i) += 1e-8 * (i % 3);
    soup.triangles.reshaped()(i) = i;
  }
  scene.components = {soup};
  const auto pieces = PiecesOf(scene);
  ASSERT_THAT(Sizes(pieces), ::testing::ElementsAre(12));
  EXPECT_EQ(pieces[0].surface.vertices.cols(), 8);
  EXPECT_TRUE(pieces[0].is_closed);
}

TEST(PiecesOf, HasNoneForNothing) { EXPECT_TRUE(PiecesOf(Scene()).empty()); }

}  // namespace
}  // namespace mortise::mesh
