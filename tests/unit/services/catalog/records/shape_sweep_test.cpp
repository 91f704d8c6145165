// Shapes that nothing names go after an hour, whatever comes first: the import or the sweep.
#include "services/catalog/records/shape_sweep.h"

#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/shape_records.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

v1::Shape Tetrahedron(double size) {
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 4);
  surface.vertices << 0, size, 0, 0, 0, 0, size, 0, 0, 0, 0, size;
  surface.triangles.resize(3, 4);
  surface.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  return NamedShape(mesh::ShapeOfMesh(surface).value());
}

class ShapeSweepTest : public ::testing::Test {
 protected:
  ShapeSweepTest() {
    v1::Material steel;
    steel.set_name("materials/steel");
    steel.set_title("Steel");
    steel.set_density(7850);
    steel.set_youngs_modulus(2e11);
    steel.set_poissons_ratio(0.3);
    steel.set_strength(2e8);
    EXPECT_TRUE(InTransaction([&](store::Transaction& transaction) {
                  return CreateMaterial(transaction, steel, {}).status();
                }).ok());
  }

  absl::Status InTransaction(const std::function<absl::Status(store::Transaction&)>& change) {
    return store_->Transact(change);
  }

  absl::Status Import(const v1::Shape& shape) {
    return InTransaction([&](store::Transaction& transaction) {
      return ImportShape(transaction, shape, {}).status();
    });
  }

  // Adds an item, 0.1 m along all axes, or gives it another shape.
  absl::Status PutItem(const std::string& id, const std::string& shape) {
    return InTransaction([&](store::Transaction& transaction) -> absl::Status {
      v1::Item item;
      item.set_name("items/" + id);
      item.set_title(id);
      item.set_kind(v1::HARDWARE);
      item.set_material("materials/steel");
      item.set_shape(shape);
      item.set_price_basis(v1::PER_PIECE);
      item.mutable_price()->set_currency("EUR");
      item.mutable_price()->set_amount(1);
      item.set_price_date("2026-01-15");
      for (const v1::Axis axis : {v1::X, v1::Y, v1::Z}) {
        v1::ItemDimension& dimension = *item.add_dimensions();
        dimension.set_axis(axis);
        dimension.set_size(0.1);
      }
      const auto present = GetItem(transaction, item.name());
      if (absl::IsNotFound(present.status())) return CreateItem(transaction, item, {}).status();
      MORTISE_RETURN_IF_ERROR(present.status());
      v1::UpdateItemRequest update;
      item.set_revision(present->revision());
      *update.mutable_item() = item;
      return UpdateItem(transaction, update, {}).status();
    });
  }

  absl::Status DeleteItemOf(const std::string& id) {
    return InTransaction([&](store::Transaction& transaction) -> absl::Status {
      v1::DeleteItemRequest request;
      request.set_name("items/" + id);
      MORTISE_ASSIGN_OR_RETURN(const v1::Item item, GetItem(transaction, request.name()));
      request.set_revision(item.revision());
      return DeleteItem(transaction, request, {});
    });
  }

  bool IsThere(const v1::Shape& shape) {
    const absl::Status read = store_->Read([&](store::ReadTransaction& transaction) {
      return GetShape(transaction, shape.name()).status();
    });
    return read.ok();
  }

  std::size_t Sweep() {
    const auto removed = SweepShapes(*store_);
    EXPECT_TRUE(removed.ok()) << removed.status();
    return removed->size();
  }

  testing::TemporaryFolder folder_;
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string()),
                        .clock = [this] { return now_; }})
          .value();
  const v1::Shape shape_ = Tetrahedron(0.1);
};

TEST_F(ShapeSweepTest, SparesWhatIsYoung) {
  ASSERT_TRUE(Import(shape_).ok());
  now_ += absl::Minutes(59);
  EXPECT_EQ(Sweep(), 0u);
  EXPECT_TRUE(IsThere(shape_));
  now_ += absl::Minutes(2);
  EXPECT_EQ(Sweep(), 1u);
  EXPECT_FALSE(IsThere(shape_));
  EXPECT_EQ(Sweep(), 0u);
}

TEST_F(ShapeSweepTest, SparesWhatAnyRevisionOfAnItemHas) {
  ASSERT_TRUE(Import(shape_).ok());
  ASSERT_TRUE(PutItem("knob", shape_.name()).ok());
  now_ += absl::Hours(5);
  EXPECT_EQ(Sweep(), 0u);
  ASSERT_TRUE(PutItem("knob", "").ok());
  EXPECT_EQ(Sweep(), 0u);  // the first revision still has it
  ASSERT_TRUE(DeleteItemOf("knob").ok());
  EXPECT_EQ(Sweep(), 1u);
  EXPECT_FALSE(IsThere(shape_));
}

TEST_F(ShapeSweepTest, AnImportBeforeTheSweepKeepsTheShape) {
  ASSERT_TRUE(Import(shape_).ok());
  now_ += absl::Hours(5);
  // It is there already, which must not mean that it goes before its item comes.
  ASSERT_TRUE(Import(shape_).ok());
  EXPECT_EQ(Sweep(), 0u);
  EXPECT_TRUE(PutItem("knob", shape_.name()).ok());
  now_ += absl::Hours(5);
  EXPECT_EQ(Sweep(), 0u);
}

TEST_F(ShapeSweepTest, AnImportAfterTheSweepBringsTheShapeBack) {
  ASSERT_TRUE(Import(shape_).ok());
  now_ += absl::Hours(5);
  EXPECT_EQ(Sweep(), 1u);
  const absl::Status without = PutItem("knob", shape_.name());
  EXPECT_EQ(DetailOf(without).field, "item.shape") << without;
  ASSERT_TRUE(Import(shape_).ok());
  EXPECT_TRUE(PutItem("knob", shape_.name()).ok());
  EXPECT_TRUE(IsThere(shape_));
}

TEST_F(ShapeSweepTest, AnAssemblyThatWasPreparedBeforeTheSweepBringsItsShapes) {
  ASSERT_TRUE(Import(shape_).ok());
  ASSERT_TRUE(PutItem("knob", shape_.name()).ok());
  v1::AssemblyBundle bundle;
  *bundle.add_shapes() = shape_;  // as Freeze read it
  now_ += absl::Hours(5);
  ASSERT_TRUE(DeleteItemOf("knob").ok());
  EXPECT_EQ(Sweep(), 1u);
  ASSERT_TRUE(InTransaction([&](store::Transaction& transaction) {
                return PutShape(transaction, bundle.shapes(0)).status();
              }).ok());
  EXPECT_TRUE(IsThere(shape_));
}

TEST_F(ShapeSweepTest, FindsNamesInRecordsOfAnyKind) {
  const v1::Shape other = Tetrahedron(0.2), third = Tetrahedron(0.3);
  for (const v1::Shape& shape : {shape_, other, third}) ASSERT_TRUE(Import(shape).ok());
  ASSERT_TRUE(InTransaction([&](store::Transaction& transaction) -> absl::Status {
                v1::AssemblyBundle assembly;
                assembly.mutable_assembly()->add_parts()->set_shape(shape_.name());
                MORTISE_RETURN_IF_ERROR(
                    transaction.Put("assemblies", "a", assembly.SerializeAsString()).status());
                v1::TemplateBundle bundle;
                bundle.add_items()->set_shape(other.name());
                return transaction.Put("templates", "t", bundle.SerializeAsString()).status();
              }).ok());
  now_ += absl::Hours(5);
  EXPECT_EQ(Sweep(), 1u);
  EXPECT_TRUE(IsThere(shape_));
  EXPECT_TRUE(IsThere(other));
  EXPECT_FALSE(IsThere(third));
}

}  // namespace
}  // namespace mortise::catalog
