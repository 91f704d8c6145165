// Shapes in the store: kept once, under the digest of their content, which is checked.
#include "services/catalog/records/shape_records.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

mesh::DrawnShape Tetrahedron() {
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 4);
  surface.vertices << 0, 0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1;
  surface.triangles.resize(3, 4);
  surface.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  return mesh::ShapeOfMesh(surface).value();
}

class ShapeRecordsTest : public ::testing::Test {
 protected:
  absl::StatusOr<bool> Put(const v1::Shape& shape) {
    absl::StatusOr<bool> is_new = false;
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      is_new = PutShape(transaction, shape);
      return is_new.status();
    });
    return stored.ok() ? is_new : stored;
  }

  absl::StatusOr<v1::Shape> Get(const std::string& name) {
    absl::StatusOr<v1::Shape> shape = absl::UnknownError("not read");
    const absl::Status read = store_->Read([&](store::ReadTransaction& transaction) {
      shape = GetShape(transaction, name);
      return shape.status();
    });
    return read.ok() ? shape : read;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string())})
          .value();
};

TEST_F(ShapeRecordsTest, AreKeptOnceUnderTheirDigest) {
  const v1::Shape shape = NamedShape(Tetrahedron());
  EXPECT_EQ(shape.name(), parametric::NameOf(shape));
  EXPECT_EQ(Put(shape).value_or(false), true);
  EXPECT_EQ(Put(shape).value_or(true), false);
  const auto found = Get(shape.name());
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->SerializeAsString(), shape.SerializeAsString());
}

TEST_F(ShapeRecordsTest, AreRefusedWhereTheyAreNotWhatTheirNameSays) {
  v1::Shape shape = NamedShape(Tetrahedron());
  shape.set_brep("other surfaces");
  ASSERT_TRUE(Put(shape).ok());
  const absl::Status status = Get(shape.name()).status();
  EXPECT_EQ(DetailOf(status).reason, "STORAGE_FAILED") << status;
  EXPECT_EQ(Get("shapes/" + std::string(64, '0')).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(DetailOf(Get("shapes/../x").status()).field, "name");
}

// What is left out takes no room from what comes after it.
TEST(NameWhatDoesNotFit, LeavesOutOnlyWhatDoesNotFit) {
  v1::TemplateBundle bundle;
  for (const auto& [name, bytes] : {std::pair{"a", 1'000'000},
                                    {"b", 4'000'000},
                                    {"c", 1'500'000},
                                    {"d", 1'000'000},
                                    {"e", 400'000}}) {
    v1::Shape& shape = *bundle.add_shapes();
    shape.set_name(name);
    shape.set_vertices(std::string(static_cast<std::size_t>(bytes), 'x'));
  }
  NameWhatDoesNotFit(bundle);
  std::string kept, named;
  for (const v1::Shape& shape : bundle.shapes()) kept += shape.name();
  for (const std::string& name : bundle.more_shapes()) named += name;
  EXPECT_EQ(kept, "ace");
  EXPECT_EQ(named, "bd");
}

}  // namespace
}  // namespace mortise::catalog
