#include "common/mesh/scenes/mesh_components.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/support/scene_files.h"

namespace mortise::mesh {
namespace {

using testing::PlainMesh;

SceneComponent ToComponent(const PlainMesh& mesh, double shift = 0) {
  SceneComponent component;
  component.vertices = (mesh.points.cast<double>().array() + shift).matrix();
  component.triangles = mesh.triangles;
  return component;
}

// The same triangles, each with vertices of its own.
SceneComponent Soup(const SceneComponent& component) {
  SceneComponent soup;
  soup.vertices.resize(3, 3 * component.triangles.cols());
  soup.triangles.resize(3, component.triangles.cols());
  for (Eigen::Index i = 0; i < soup.vertices.cols(); ++i) {
    soup.vertices.col(i) = component.vertices.col(component.triangles.reshaped()(i));
    soup.triangles.reshaped()(i) = static_cast<int>(i);
  }
  return soup;
}

SceneComponent Two(const SceneComponent& one, const SceneComponent& other) {
  Scene scene;
  scene.components = {one, other};
  return Joined(scene);
}

ConnectedTriangles Connected(const SceneComponent& component, double tolerance = 0) {
  return FindConnected(component.vertices, component.triangles, tolerance);
}

TEST(WeldPoints, NumbersPlacesInTheirOrder) {
  Eigen::Matrix3Xd points(3, 5);
  points << 1, 2, 1, 0, -0.0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  const Eigen::VectorXi places = WeldPoints(points);
  EXPECT_THAT(std::vector<int>(places.begin(), places.end()),
              ::testing::ElementsAre(0, 1, 0, 2, 2));
}

TEST(WeldPoints, JoinsWhatIsNearerThanTheTolerance) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0, 1);
  Eigen::Matrix3Xd points(3, 400);
  for (double& number : points.reshaped()) number = place(random);
  const double tolerance = 0.05;
  const Eigen::VectorXi places = WeldPoints(points, tolerance);
  EXPECT_GT(places.maxCoeff(), 20);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const bool is_near = (points.col(i) - points.col(j)).norm() < tolerance;
      EXPECT_TRUE(!is_near || places(i) == places(j));
    }
  }
}

TEST(WeldPoints, KeepsApartWhatIsFartherThanItSays) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 50);
  for (Eigen::Index i = 0; i < points.cols(); ++i) points(0, i) = 3.6 * static_cast<double>(i);
  EXPECT_EQ(WeldPoints(points, 1).maxCoeff(), 49);
}

TEST(WeldPoints, TakesPointsThatAllLieInOneCell) {
  // A far point makes the tolerance as wide as all others together.
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 200'000);
  points.col(0).setConstant(1e12);
  EXPECT_EQ(WeldPoints(points, 1e6).maxCoeff(), 1);
}

TEST(WeldPoints, TakesNone) { EXPECT_EQ(WeldPoints(Eigen::Matrix3Xd(3, 0), 1).size(), 0); }

TEST(ConnectedTriangles, HangTogetherBySharedVertices) {
  const SceneComponent sheet = ToComponent(testing::Sheet(6));
  EXPECT_EQ(Connected(sheet).count, 1);
  const ConnectedTriangles two = Connected(Two(sheet, ToComponent(testing::Tetrahedron(), 5)));
  EXPECT_EQ(two.count, 2);
  EXPECT_EQ(two.piece(0), 0);
  EXPECT_EQ(two.piece(two.piece.size() - 1), 1);
}

TEST(ConnectedTriangles, OfASoupHangTogetherWhereTheyTouch) {
  const SceneComponent sheet = ToComponent(testing::Sheet(6));
  EXPECT_EQ(Connected(Soup(sheet)).count, 1);
  EXPECT_EQ(Connected(Soup(Two(sheet, ToComponent(testing::Tetrahedron(), 5)))).count, 2);
}

TEST(ConnectedTriangles, OfASoupWithRoundedCornersHangTogetherWithinATolerance) {
  SceneComponent soup = Soup(ToComponent(testing::Sheet(6)));
  std::mt19937 random(8);
  std::uniform_real_distribution<double> error(-1e-7, 1e-7);
  for (double& number : soup.vertices.reshaped()) number += error(random);
  EXPECT_EQ(Connected(soup).count, soup.triangles.cols());
  EXPECT_EQ(Connected(soup, 1e-6).count, 1);
}

TEST(ConnectedTriangles, AreTheSameInAnyOrder) {
  SceneComponent soup =
      Soup(Two(ToComponent(testing::Sheet(5)), ToComponent(testing::Sheet(4), 3)));
  std::vector<int> order(static_cast<std::size_t>(soup.triangles.cols()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::mt19937 random(2);
  std::shuffle(order.begin(), order.end(), random);
  soup.triangles = soup.triangles(Eigen::all, order).eval();
  const ConnectedTriangles connected = Connected(soup, 1e-9);
  EXPECT_EQ(connected.count, 2);
  EXPECT_EQ(
      std::min((connected.piece.array() == 0).count(), (connected.piece.array() == 1).count()),
      2 * 4 * 4);
}

TEST(ConnectedTriangles, AreNoneOfNone) {
  EXPECT_EQ(FindConnected(Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0), 1e-6).count, 0);
}

TEST(Separated, GivesEachPieceItsVerticesAndANumber) {
  SceneComponent legs = Two(ToComponent(testing::Tetrahedron()), ToComponent(testing::Sheet(2), 9));
  legs.name = "leg";
  const std::vector<SceneComponent> pieces = Separated(legs);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].name, "leg 1");
  EXPECT_EQ(pieces[1].name, "leg 2");
  EXPECT_EQ(pieces[0].vertices.cols(), 4);
  EXPECT_EQ(pieces[1].vertices, ToComponent(testing::Sheet(2), 9).vertices);
  EXPECT_EQ(pieces[1].triangles, testing::Sheet(2).triangles);
}

TEST(Separated, KeepsTheNameOfOnePiece) {
  SceneComponent top = ToComponent(testing::Tetrahedron());
  top.name = "top";
  EXPECT_EQ(Separated(top)[0].name, "top");
  EXPECT_EQ(Separated(Two(top, ToComponent(testing::Tetrahedron(), 5)))[1].name, "2");
}

}  // namespace
}  // namespace mortise::mesh
