// Drawings are copied without loss, whatever becomes of their parts.
#include "services/composer/records/drawing.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {
namespace {

// An assembly that ships, with everything it may use.
v1::AssemblyBundle Shipped(const std::string& name) {
  const parametric::Collection& collection = parametric::WhatShips();
  v1::AssemblyBundle bundle;
  for (const v1::Assembly& assembly : collection.assemblies) {
    if (assembly.name() == name) *bundle.mutable_assembly() = assembly;
  }
  EXPECT_GT(bundle.assembly().parts_size(), 0) << name;
  *bundle.mutable_items() = {collection.items.begin(), collection.items.end()};
  *bundle.mutable_materials() = {collection.materials.begin(), collection.materials.end()};
  *bundle.mutable_shapes() = {collection.shapes.begin(), collection.shapes.end()};
  return bundle;
}

// The assembly of a drawing, each part and joint of it as a copy of itself.
absl::StatusOr<Drawing> Copied(const Drawing& drawing, const parametric::Assembly& assembly,
                               const std::string& name) {
  std::vector<CopiedFrom> parts, joints;
  for (const auto& part : assembly.parts) parts.push_back({&drawing, part.name});
  for (const auto& joint : assembly.joints) joints.push_back({&drawing, joint.name});
  return DrawAnew(name, assembly, parts, joints);
}

class ShippedDrawing : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(OfTheCollection, ShippedDrawing,
                         ::testing::Values("assemblies/bookshelf", "assemblies/cabinet",
                                           "assemblies/toy-wagon", "assemblies/go-kart"),
                         [](const auto& tested) {
                           std::string name = std::string(tested.param).substr(11);
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(ShippedDrawing, IsReadPartByPartToTheLastBit) {
  const v1::AssemblyBundle bundle = Shipped(GetParam());
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly assembly, ReadAssembly(bundle));
  ASSERT_OK_AND_ASSIGN(const Drawing drawing, ReadDrawing(bundle));
  EXPECT_EQ(drawing.bundle.assembly().parts_size(), static_cast<int>(assembly.parts.size()));
  EXPECT_TRUE(IsDrawnAs(drawing, assembly));
}

TEST_P(ShippedDrawing, IsCopiedToTheLastBitAndUsesWhatItNeeds) {
  ASSERT_OK_AND_ASSIGN(const Drawing drawing, ReadDrawing(Shipped(GetParam())));
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly assembly, ReadAssembly(drawing.bundle));
  ASSERT_OK_AND_ASSIGN(const Drawing copy, Copied(drawing, assembly, "assemblies/copy"));
  EXPECT_TRUE(IsDrawnAs(copy, assembly));
  EXPECT_EQ(ShapesUsed(copy.bundle).size(), static_cast<std::size_t>(copy.bundle.shapes_size()));
  EXPECT_LT(copy.bundle.items_size(), drawing.bundle.items_size());
  // The same thing again has the same digest; another name is another drawing.
  ASSERT_OK_AND_ASSIGN(const Drawing again, Copied(drawing, assembly, "assemblies/copy"));
  EXPECT_EQ(again.digest, copy.digest);
  ASSERT_OK_AND_ASSIGN(const Drawing other, Copied(drawing, assembly, "assemblies/other"));
  EXPECT_NE(other.digest, copy.digest);
}

TEST_P(ShippedDrawing, StaysWhereItIsMovedTo) {
  ASSERT_OK_AND_ASSIGN(const Drawing drawing, ReadDrawing(Shipped(GetParam())));
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, ReadAssembly(drawing.bundle));
  const Eigen::Vector3d shift(1.0 / 3, -0.7, 1e-4);
  for (parametric::AssemblyPart& part : assembly.parts) {
    part.box.minimum += shift;
    part.box.maximum += shift;
    for (parametric::ProminentPlane& plane : part.prominent_planes) {
      plane.position += shift[static_cast<Eigen::Index>(plane.axis)];
    }
  }
  for (parametric::Joint& joint : assembly.joints) joint.center += shift;
  ASSERT_OK_AND_ASSIGN(const Drawing copy, Copied(drawing, assembly, "assemblies/copy"));
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly read, ReadAssembly(copy.bundle));
  for (std::size_t i = 0; i < read.parts.size(); ++i) {
    EXPECT_LT((read.parts[i].box.minimum - assembly.parts[i].box.minimum).norm(), 1e-15);
    EXPECT_LT((read.parts[i].box.maximum - assembly.parts[i].box.maximum).norm(), 1e-15);
  }
}

TEST(Drawing, OfTagsAndRevisionsIsTheSame) {
  v1::AssemblyBundle bundle = Shipped("assemblies/bookshelf");
  const Drawing plain = MakeDrawing(bundle);
  bundle.mutable_assembly()->set_revision(7);
  bundle.mutable_assembly()->add_external_ids("100-4711/A");
  (*bundle.mutable_assembly()->mutable_labels())["customer"] = "acme";
  bundle.mutable_items(0)->set_revision(3);
  bundle.mutable_items(0)->mutable_create_time()->set_seconds(1795000000);
  bundle.mutable_items(0)->mutable_update_time()->set_seconds(1795000001);
  bundle.mutable_items(0)->set_creator("ada");
  bundle.mutable_materials(0)->mutable_create_time()->set_seconds(1795000000);
  EXPECT_EQ(MakeDrawing(bundle).digest, plain.digest);
  bundle.mutable_items(0)->mutable_price()->set_amount(4711);
  EXPECT_NE(MakeDrawing(bundle).digest, plain.digest);
}

TEST(Drawing, IsNotMadeOfItemsThatDiffer) {
  const v1::AssemblyBundle one = Shipped("assemblies/bookshelf");
  v1::AssemblyBundle other = one;
  v1::AssemblyBundle together = one;
  other.mutable_items(0)->mutable_price()->set_amount(1234);
  other.mutable_items(0)->set_revision(9);
  ASSERT_OK(CombineItems(other, &together));
  EXPECT_EQ(together.items(0).price().amount(), 1234);
  other.mutable_items(0)->mutable_dimensions(0)->set_size(17);
  const absl::Status differs = CombineItems(other, &together);
  EXPECT_EQ(DetailOf(differs).reason, "ITEM_DIFFERS");
  EXPECT_EQ(DetailOf(differs).field, one.items(0).name());
}

}  // namespace
}  // namespace mortise::composer
