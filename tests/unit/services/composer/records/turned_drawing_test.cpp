// Drawings turned by right angles are the same things lying otherwise.
#include "services/composer/records/turned_drawing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "common/assembly/model/linear_design.h"
#include "common/mesh/mass_properties.h"
#include "services/composer/model/quarter_turn.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {
namespace {

constexpr Axis kX = Axis::kX, kY = Axis::kY, kZ = Axis::kZ;

Drawing ShippedDrawing(const std::string& name) {
  const parametric::Collection& collection = parametric::WhatShips();
  v1::AssemblyBundle bundle;
  for (const v1::Assembly& assembly : collection.assemblies) {
    if (assembly.name() == name) *bundle.mutable_assembly() = assembly;
  }
  *bundle.mutable_items() = {collection.items.begin(), collection.items.end()};
  *bundle.mutable_materials() = {collection.materials.begin(), collection.materials.end()};
  *bundle.mutable_shapes() = {collection.shapes.begin(), collection.shapes.end()};
  return ReadDrawing(bundle).value();
}

// What is bought for each part: the item, and how much of it along its own axes, in micrometres.
std::map<std::string, std::string> BoughtFor(const parametric::Assembly& assembly) {
  std::map<std::string, std::string> bought;
  for (const parametric::AssemblyPart& part : assembly.parts) {
    std::string& each = bought[part.name];
    each = part.item;
    for (const Axis axis : part.item_axes) {
      const double size = part.box.size()[static_cast<Eigen::Index>(axis)];
      each += " " + std::to_string(std::lround(1e6 * size));
    }
  }
  return bought;
}

class TurnedDrawingTest : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(OfTheCollection, TurnedDrawingTest,
                         ::testing::Values("assemblies/bookshelf", "assemblies/cabinet",
                                           "assemblies/go-kart", "assemblies/dining-table",
                                           "assemblies/pendant-lamp"),
                         [](const auto& tested) {
                           std::string name = std::string(tested.param).substr(11);
                           std::erase(name, '-');
                           return name;
                         });

// What is read of it is the assembly turned: every part where it goes, made of the same, and with
// the looks that it has, turned.
TEST_P(TurnedDrawingTest, IsReadAsTheAssemblyTurned) {
  const Drawing drawing = ShippedDrawing(GetParam());
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly drawn, ReadAssembly(drawing.bundle));
  for (const std::vector<Axis>& axes :
       {std::vector<Axis>{kZ}, {kZ, kZ}, {kZ, kZ, kZ}, {kX}, {kY, kY}, {kY, kX}}) {
    const Eigen::Matrix3d turn = TurnOf(axes);
    ASSERT_OK_AND_ASSIGN(const Drawing turned, TurnedDrawing(drawing, turn));
    ASSERT_OK_AND_ASSIGN(const parametric::Assembly read, ReadAssembly(turned.bundle));
    const parametric::Assembly wanted = Turned(drawn, turn);
    EXPECT_EQ(BoughtFor(read), BoughtFor(drawn));
    ASSERT_EQ(read.parts.size(), wanted.parts.size());
    for (std::size_t i = 0; i < read.parts.size(); ++i) {
      const parametric::AssemblyPart &a = read.parts[i], &b = wanted.parts[i];
      SCOPED_TRACE(a.name);
      EXPECT_LT((a.box.minimum - b.box.minimum).norm(), 1e-12);
      EXPECT_LT((a.box.maximum - b.box.maximum).norm(), 1e-12);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(a.limits[axis].minimum, b.limits[axis].minimum, 1e-12);
        EXPECT_NEAR(a.limits[axis].maximum, b.limits[axis].maximum, 1e-12);
      }
      const auto of_a = mesh::ComputeMassProperties(parametric::SurfaceOf(a));
      const auto of_b = mesh::ComputeMassProperties(parametric::SurfaceOf(b));
      EXPECT_NEAR(of_a.volume, of_b.volume, 1e-6 * of_b.volume);
      EXPECT_LT((of_a.centroid - of_b.centroid).norm(), 1e-6);
    }
    for (std::size_t j = 0; j < read.joints.size(); ++j) {
      const parametric::Joint &a = read.joints[j], &b = wanted.joints[j];
      EXPECT_LT((a.center - b.center).norm(), 1e-12);
      EXPECT_LT((a.axis - b.axis).norm(), 1e-12);
      ASSERT_EQ(a.rest_poses.size(), b.rest_poses.size());
      for (std::size_t k = 0; k < a.rest_poses.size(); ++k) {
        EXPECT_LT((a.rest_poses[k].motion - b.rest_poses[k].motion).norm(), 1e-12);
      }
    }
  }
}

TEST_P(TurnedDrawingTest, IsTheSameWhicheverWayItIsTurnedThere) {
  const Drawing drawing = ShippedDrawing(GetParam());
  ASSERT_OK_AND_ASSIGN(const Drawing none, TurnedDrawing(drawing, TurnOf({kZ, kZ, kZ, kZ})));
  EXPECT_EQ(none.digest, drawing.digest);
  ASSERT_OK_AND_ASSIGN(const Drawing once, TurnedDrawing(drawing, TurnOf({kX, kX, kY})));
  ASSERT_OK_AND_ASSIGN(const Drawing again, TurnedDrawing(drawing, TurnOf({kY, kZ, kZ})));
  EXPECT_EQ(once.digest, again.digest);
  EXPECT_NE(once.digest, drawing.digest);
}

// Screws and boards need no shapes of their own; a bracket that is drawn by itself does, and its
// exact solid turns with it.
TEST(TurnedDrawingTest, KeepsTheShapesThatSayIt) {
  const Drawing shelf = ShippedDrawing("assemblies/bookshelf");
  ASSERT_OK_AND_ASSIGN(const Drawing turned, TurnedDrawing(shelf, TurnOf({kZ})));
  for (const v1::AssemblyPart& part : turned.bundle.assembly().parts()) {
    EXPECT_EQ(part.shape(), "") << part.name();
  }
  const Drawing table = ShippedDrawing("assemblies/dining-table");
  ASSERT_OK_AND_ASSIGN(const Drawing lying, TurnedDrawing(table, TurnOf({kZ})));
  bool found = false;
  for (int i = 0; i < lying.bundle.assembly().parts_size(); ++i) {
    const std::string& before = table.bundle.assembly().parts(i).shape();
    if (before.empty()) continue;
    found = true;
    EXPECT_NE(lying.bundle.assembly().parts(i).shape(), before);
  }
  EXPECT_TRUE(found);
  for (const v1::Shape& shape : lying.bundle.shapes()) {
    EXPECT_TRUE(shape.exact()) << shape.name();
  }
}

}  // namespace
}  // namespace mortise::composer
