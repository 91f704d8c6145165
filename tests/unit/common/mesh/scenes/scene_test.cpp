#include "common/mesh/scenes/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

namespace mortise::mesh {
namespace {

// A triangle from the origin along x and y, this long.
SceneComponent Triangle(const std::string& name, double length) {
  SceneComponent component;
  component.name = name;
  component.vertices.resize(3, 3);
  component.vertices << 0, length, 0, 0, 0, length, 0, 0, 0;
  component.triangles.resize(3, 1);
  component.triangles << 0, 1, 2;
  return component;
}

Scene OfDiagonal(double diagonal) {
  Scene scene;
  scene.components.push_back(Triangle("", diagonal / std::sqrt(2.0)));
  return scene;
}

TEST(Scene, JoinsItsComponentsInTheirOrder) {
  Scene scene;
  scene.components = {Triangle("small", 1), Triangle("large", 5)};
  const SceneComponent joined = Joined(scene);
  EXPECT_EQ(TriangleCount(scene), 2);
  ASSERT_EQ(joined.triangles.cols(), 2);
  EXPECT_EQ(joined.vertices.col(joined.triangles(1, 0)), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(joined.vertices.col(joined.triangles(1, 1)), Eigen::Vector3d(5, 0, 0));
}

TEST(Scene, HasABoxOfWhatItsTrianglesUse) {
  Scene scene = OfDiagonal(std::sqrt(2.0));
  scene.components[0].vertices.conservativeResize(3, 4);
  scene.components[0].vertices.col(3).setConstant(100);
  EXPECT_TRUE(BoxOf(scene).sizes().isApprox(Eigen::Vector3d(1, 1, 0)));
  EXPECT_TRUE(BoxOf(Scene()).isEmpty());
}

TEST(Scene, IsInMetresOnceItIsScaled) {
  const Scene scaled = Scaled(OfDiagonal(1000 * std::sqrt(2.0)), 0.001);
  EXPECT_NEAR(BoxOf(scaled).sizes().x(), 1, 1e-12);
  EXPECT_EQ(scaled.unit, 1);
}

TEST(Scene, IsTurnedSoThatUpIsZ) {
  for (const auto& [up, axis] : {std::pair{UpAxis::kX, 0}, {UpAxis::kY, 1}, {UpAxis::kZ, 2}}) {
    Scene scene;
    scene.components.push_back(Triangle("", 1));
    scene.components[0].vertices = Eigen::Matrix3d::Identity();
    const Scene turned = TurnedUpright(scene, up);
    const Eigen::Matrix3d turn = turned.components[0].vertices;
    EXPECT_EQ(turn.col(axis), Eigen::Vector3d::UnitZ());
    EXPECT_EQ(turn.determinant(), 1);
    EXPECT_EQ(turned.up, UpAxis::kZ);
  }
}

TEST(Scene, StaysAsItIsWhereNobodyKnowsWhatIsUp) {
  const Scene scene = TurnedUpright(OfDiagonal(1), UpAxis::kUnknown);
  EXPECT_EQ(scene.components[0].vertices, OfDiagonal(1).components[0].vertices);
  EXPECT_EQ(scene.up, UpAxis::kUnknown);
}

TEST(UnitGuess, GoesByTheDiagonal) {
  EXPECT_EQ(GuessUnit(OfDiagonal(1.2))->unit, 1);
  EXPECT_EQ(GuessUnit(OfDiagonal(120))->unit, 0.01);
  EXPECT_EQ(GuessUnit(OfDiagonal(1200))->unit, 0.001);
  EXPECT_FALSE(GuessUnit(OfDiagonal(0.05)));
  EXPECT_FALSE(GuessUnit(OfDiagonal(1e6)));
  EXPECT_FALSE(GuessUnit(Scene()));
}

TEST(UnitGuess, SaysThatItIsAGuess) {
  EXPECT_EQ(GuessUnit(OfDiagonal(812))->remark,
            "The unit is a guess: millimetres, as the surface measures 812 across.");
}

TEST(Settled, TakesWhatIsSaidBeforeWhatTheFileSays) {
  Scene scene = OfDiagonal(std::sqrt(2.0));
  scene.unit = 0.001;
  scene.up = UpAxis::kY;
  const Scene as_filed = Settled(scene, UpAxis::kUnknown, std::nullopt);
  EXPECT_NEAR(BoxOf(as_filed).sizes().x(), 0.001, 1e-15);
  EXPECT_NEAR(BoxOf(as_filed).sizes().z(), 0.001, 1e-15);
  EXPECT_TRUE(as_filed.notes.empty());
  const Scene as_said = Settled(scene, UpAxis::kZ, 0.01);
  EXPECT_NEAR(BoxOf(as_said).sizes().y(), 0.01, 1e-15);
}

TEST(Settled, TellsWhatItGuessesOrDoesNotKnow) {
  const Scene guessed = Settled(OfDiagonal(1200), UpAxis::kUnknown, std::nullopt);
  EXPECT_EQ(guessed.unit, 1);
  EXPECT_EQ(guessed.notes.size(), 1u);
  const Scene unknown = Settled(OfDiagonal(1e6), UpAxis::kUnknown, std::nullopt);
  EXPECT_FALSE(unknown.unit);
  EXPECT_EQ(unknown.notes.size(), 1u);
}

TEST(UpAxis, IsNumberedAsInContracts) {
  EXPECT_EQ(UpAxisOf(2), UpAxis::kY);
  for (const int number : {-1, 0, 4}) EXPECT_EQ(UpAxisOf(number), UpAxis::kUnknown);
}

}  // namespace
}  // namespace mortise::mesh
