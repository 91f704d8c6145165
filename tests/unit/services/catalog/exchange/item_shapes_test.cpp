// The shapes that ship are what their drawings give, and as large as the items that have them.
#include "tools/item_shapes/item_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "common/base/files.h"
#include "common/files/collection.h"

namespace mortise::catalog {
namespace {

std::filesystem::path CollectionFolder() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "collection";
}

const std::vector<ItemShape>& ShapeList() {
  static const auto* const list =
      new std::vector<ItemShape>(ReadShapeList(CollectionFolder() / "shapes").value());
  return *list;
}

absl::StatusOr<v1::Shape> Committed(const std::string& name) {
  const auto bytes = ReadFile(CollectionFolder() / "shapes" / (name + ".shape"));
  if (!bytes.ok()) return bytes.status();
  v1::Shape shape;
  if (!shape.ParseFromString(*bytes)) return absl::InternalError(name + " is no shape");
  return shape;
}

void ExpectSame(const v1::Shape& shape, const v1::Shape& expected) {
  EXPECT_NEAR(shape.volume(), expected.volume(), 1e-9 * expected.volume());
  EXPECT_NEAR(shape.size().x(), expected.size().x(), 1e-9);
  EXPECT_NEAR(shape.size().y(), expected.size().y(), 1e-9);
  EXPECT_NEAR(shape.size().z(), expected.size().z(), 1e-9);
}

TEST(ItemShapes, EachIsDrawnAndUsed) {
  std::set<std::string> listed, present;
  for (const ItemShape& shape : ShapeList()) {
    EXPECT_TRUE(listed.insert(shape.name).second) << shape.name;
  }
  for (const auto& entry : std::filesystem::directory_iterator(CollectionFolder() / "shapes")) {
    if (entry.path().extension() != ".shape") continue;
    present.insert(entry.path().stem().string());
    EXPECT_TRUE(std::filesystem::exists(entry.path().parent_path() /
                                        (entry.path().stem().string() + ".step")));
  }
  EXPECT_EQ(present, listed);
  const auto collection = parametric::ReadCollection(CollectionFolder());
  ASSERT_TRUE(collection.ok()) << collection.status();
  EXPECT_EQ(collection->shapes.size(), listed.size());
}

// One of each drawing, from its features to the file, and to the shape in that.
TEST(ItemShapes, AreWhatTheirDrawingsGive) {
  std::set<std::string> seen;
  for (const ItemShape& shape : ShapeList()) {
    if (!seen.insert(shape.drawing).second) continue;
    SCOPED_TRACE(shape.name);
    const auto committed = Committed(shape.name);
    ASSERT_TRUE(committed.ok()) << committed.status();
    const auto file = ReadFile(CollectionFolder() / "shapes" / (shape.name + ".step"));
    ASSERT_TRUE(file.ok()) << file.status();
    const auto of_file = ShapeOfFile(*file);
    ASSERT_TRUE(of_file.ok()) << of_file.status();
    ExpectSame(*of_file, *committed);
    const auto drawn = DrawSolid(CollectionFolder() / "shapes", shape);
    ASSERT_TRUE(drawn.ok()) << drawn.status();
    // What the kernel writes and reads again has the same volume to 1e-6 (docs/parametrisation.md).
    EXPECT_NEAR(drawn->Volume(), committed->volume(), 1e-6 * committed->volume());
  }
}

TEST(ItemShapes, AreAsLargeAsTheirItemsAndNotTooFine) {
  const auto collection = parametric::ReadCollection(CollectionFolder());
  ASSERT_TRUE(collection.ok()) << collection.status();
  std::map<std::string, const v1::Shape*> shapes;
  for (const v1::Shape& shape : collection->shapes) {
    EXPECT_TRUE(shape.exact());
    EXPECT_LE(shape.triangle_count(), 2500) << shape.name();
    shapes[shape.name()] = &shape;
  }
  int shaped = 0;
  for (const v1::Item& item : collection->items) {
    if (item.shape().empty()) continue;
    ++shaped;
    SCOPED_TRACE(item.name());
    ASSERT_TRUE(shapes.count(item.shape()));
    const v1::Vector3& size = shapes[item.shape()]->size();
    const double sizes[] = {size.x(), size.y(), size.z()};
    for (const v1::ItemDimension& dimension : item.dimensions()) {
      if (dimension.process() != v1::PROCESS_UNSPECIFIED) continue;
      EXPECT_NEAR(sizes[dimension.axis() - v1::X], dimension.size(), 1e-6);
    }
  }
  EXPECT_GE(shaped, 75);
}

// Less than its box, and for wheels and castors more than a cylinder's worth of triangles.
TEST(ItemShapes, LookLikeWhatTheyAreCalled) {
  const auto castor = Committed("castor-plate-80");
  ASSERT_TRUE(castor.ok()) << castor.status();
  const double box = castor->size().x() * castor->size().y() * castor->size().z();
  EXPECT_LT(castor->volume(), 0.3 * box);
  EXPECT_GT(castor->triangle_count(), 500);
  const auto profile = Committed("profile-30x30-slot-8");
  ASSERT_TRUE(profile.ok()) << profile.status();
  EXPECT_LT(profile->volume(), 0.6 * 0.03 * 0.03 * profile->size().x());
  const auto bearing = Committed("bearing-6005");
  ASSERT_TRUE(bearing.ok()) << bearing.status();
  EXPECT_LT(bearing->volume(), std::acos(-1.0) / 4 * (0.047 * 0.047 - 0.025 * 0.025) * 0.012);
}

}  // namespace
}  // namespace mortise::catalog
