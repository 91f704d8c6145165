#include "common/mesh/parts/scene_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/base/errors.h"
#include "tests/support/box_scenes.h"

namespace mortise::mesh {
namespace {

using testing::Box;
using ::testing::ElementsAre;
using testing::OneComponent;
using testing::TableParts;

std::vector<std::string> Names(const SceneParts& made) {
  std::vector<std::string> names;
  for (const ScenePart& part : made.parts) names.push_back(part.name);
  return names;
}

std::vector<int> Alike(const SceneParts& made) {
  std::vector<int> alike;
  for (const ScenePart& part : made.parts) alike.push_back(part.first_alike);
  return alike;
}

TEST(PartsOf, FindsPartsThatAreAlike) {
  const auto made = PartsOf(OneComponent(TableParts()), 40);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(Alike(*made), ElementsAre(0, 1, 1, 1, 1));
  EXPECT_THAT(Names(*made), ::testing::Each(""));
}

TEST(PartsOf, CallsPartsAfterTheirComponents) {
  Scene scene;
  scene.components = {
      Box("top", {0, 0, 1}, {4, 1, 0.1}),
      OneComponent({Box("", {0, 0, 0}, {0.1, 1, 1}), Box("", {3.9, 0, 0}, {0.1, 1, 1})})
          .components[0]};
  scene.components[1].name = "side";
  const auto made = PartsOf(scene, 40);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(Names(*made), ElementsAre("top", "side 1", "side 2"));
  EXPECT_EQ(made->parts[0].group, "");
  EXPECT_EQ(made->parts[1].group, "side");
}

TEST(PartsOf, HasNoGroupWhereOneComponentIsAll) {
  Scene scene = OneComponent(TableParts());
  scene.components[0].name = "Table";
  const auto made = PartsOf(scene, 40);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(Names(*made), ElementsAre("Table 1", "Table 2", "Table 3", "Table 4", "Table 5"));
  for (const ScenePart& part : made->parts) EXPECT_EQ(part.group, "");
}

TEST(PartsOf, RefusesWhatIsNothingOrFlat) {
  EXPECT_EQ(DetailOf(PartsOf(Scene(), 40).status()).field, "file");
  SceneComponent triangle;
  triangle.vertices = (Eigen::Matrix3Xd(3, 3) << 0, 1, 0, 0, 0, 1, 0, 1, 1).finished();
  triangle.triangles = Eigen::Vector3i(0, 1, 2);
  Scene scene;
  scene.components = {triangle, testing::Moved(triangle, {1, 0, 1})};
  const auto flat = PartsOf(scene, 40);
  EXPECT_THAT(std::string(flat.status().message()), ::testing::HasSubstr("flat"));
}

// Whatever triangles there are: parts that together have each of them once, but for those that are
// drawn twice, or an error that names the file.
TEST(PartsOf, TakesAnyTriangles) {
  std::mt19937 random(5);
  for (int round = 0; round < 60; ++round) {
    const auto number = [&](int low, int high) {
      return std::uniform_int_distribution<int>(low, high)(random);
    };
    Scene scene;
    const int components = number(1, 4);
    for (int c = 0; c < components; ++c) {
      SceneComponent component;
      component.name = number(0, 1) == 0 ? "" : "some";
      const int vertices = number(3, 30);
      component.vertices.resize(3, vertices);
      for (double& place : component.vertices.reshaped()) place = number(-4, 4);
      component.triangles.resize(3, number(1, 40));
      for (int& corner : component.triangles.reshaped()) corner = number(0, vertices - 1);
      scene.components.push_back(component);
    }
    const std::size_t most = static_cast<std::size_t>(number(1, 10));
    const auto made = PartsOf(scene, most);
    if (!made.ok()) {
      EXPECT_EQ(DetailOf(made.status()).field, "file") << made.status();
      continue;
    }
    ASSERT_FALSE(made->parts.empty());
    EXPECT_LE(made->parts.size(), most);
    Eigen::Index triangles = 0;
    for (std::size_t i = 0; i < made->parts.size(); ++i) {
      const ScenePart& part = made->parts[i];
      EXPECT_LE(part.first_alike, static_cast<int>(i));
      ASSERT_GT(part.surface.triangles.cols(), 0);
      EXPECT_LT(part.surface.triangles.maxCoeff(), part.surface.vertices.cols());
      triangles += part.surface.triangles.cols();
    }
    EXPECT_LE(triangles, TriangleCount(scene));
  }
}

}  // namespace
}  // namespace mortise::mesh
