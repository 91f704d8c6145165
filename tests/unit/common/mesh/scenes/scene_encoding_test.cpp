#include "common/mesh/scenes/scene_encoding.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/support/file_damage.h"
#include "tests/support/scene_files.h"

namespace mortise::mesh {
namespace {

Scene Sample() {
  Scene scene;
  scene.unit = 0.0254;
  scene.up = UpAxis::kY;
  scene.notes = {"First.", ""};
  for (const auto& mesh : {testing::Tetrahedron(), testing::Sheet(3)}) {
    SceneComponent component;
    component.name = "Stuhl ä";
    component.vertices = mesh.points.cast<double>() / 3;
    component.triangles = mesh.triangles;
    scene.components.push_back(component);
  }
  return scene;
}

TEST(SceneEncoding, KeepsAScene) {
  const Scene scene = Sample();
  const auto decoded = DecodeScene(EncodeScene(scene));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->unit, scene.unit);
  EXPECT_EQ(decoded->up, scene.up);
  EXPECT_EQ(decoded->notes, scene.notes);
  ASSERT_EQ(decoded->components.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(decoded->components[i].name, scene.components[i].name);
    EXPECT_EQ(decoded->components[i].vertices, scene.components[i].vertices);
    EXPECT_EQ(decoded->components[i].triangles, scene.components[i].triangles);
  }
}

TEST(SceneEncoding, KeepsThatTheUnitIsUnknown) {
  Scene scene = Sample();
  scene.unit.reset();
  EXPECT_FALSE(DecodeScene(EncodeScene(scene))->unit);
}

TEST(SceneEncoding, RefusesEveryBeginningOfOne) {
  const std::string bytes = EncodeScene(Sample());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(DecodeScene(bytes.substr(0, length)).ok()) << length;
  }
  EXPECT_FALSE(DecodeScene(bytes + "x").ok());
}

TEST(SceneEncoding, GivesNoIndexOutOfRangeWhateverTheBytes) {
  const std::string bytes = EncodeScene(Sample());
  std::mt19937 random(7);
  for (int i = 0; i < 500; ++i) {
    const auto decoded =
        DecodeScene(testing::Damaged(bytes, testing::Damage::kChangedBytes, random));
    if (!decoded.ok()) continue;
    for (const SceneComponent& component : decoded->components) {
      EXPECT_GE(component.triangles.minCoeff(), 0);
      EXPECT_LT(component.triangles.maxCoeff(), component.vertices.cols());
      EXPECT_TRUE(component.vertices.allFinite());
    }
  }
}

}  // namespace
}  // namespace mortise::mesh
