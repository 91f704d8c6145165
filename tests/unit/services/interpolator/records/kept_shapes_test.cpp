// What builds have found out of shapes: kept, read again, forgotten.
#include "services/interpolator/records/kept_shapes.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/services/interpolator/records/kept_versions.h"

namespace mortise::interpolator {
namespace {

KnownShapes Some(int mesh) {
  KnownShapes known;
  known.meshes[{1, mesh}] = {7, absl::OkStatus(), "abc", 1000};
  known.meshes[{1, mesh + 1}] = {8, PreconditionFailed("TOPOLOGY_DIFFERS", "no"), "", 0};
  known.shapes[{{1, mesh}, 9}] = {absl::OkStatus(), "def",        500, 2, 1.5, 1e-6,
                                  {{-1, 2}},        {0.5F, 0.25F}};
  known.differences[{{{1, mesh}, 9}, 0xfedcba9876543210U}] = {
      1.25, {3, 2, 1}, {{6, 5, 4}, {9, 8, 7}}};
  return known;
}

TEST(KeptShapesTest, ComesBackAsItWasFoundOut) {
  const mortise::testing::TemporaryFolder folder;
  const auto store =
      store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string()}).value();
  KnownShapes differences;
  differences.differences = Some(4).differences;
  const absl::Status put = store->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(PutShapes(transaction, "build", Some(0)));
    MORTISE_RETURN_IF_ERROR(PutShapes(transaction, "build", differences));
    MORTISE_RETURN_IF_ERROR(PutShapes(transaction, "build", {}));
    return PutShapes(transaction, "build2", Some(2));
  });
  ASSERT_TRUE(put.ok()) << put;
  const auto known = LoadShapes(*store, "build");
  ASSERT_TRUE(known.ok()) << known.status();
  EXPECT_EQ(known->meshes.size(), 2u);
  EXPECT_EQ(known->meshes.at({1, 0}).digest, "abc");
  EXPECT_EQ(known->meshes.at({1, 0}).number, 7);
  EXPECT_EQ(DetailOf(known->meshes.at({1, 1}).status).reason, "TOPOLOGY_DIFFERS");
  const KnownShape& shape = known->shapes.at({{1, 0}, 9});
  EXPECT_EQ(shape.digest, "def");
  EXPECT_EQ(shape.bytes, 500);
  EXPECT_EQ(shape.inverted, 2);
  EXPECT_EQ(shape.size, 1.5);
  EXPECT_EQ(shape.rounding, 1e-6);
  ASSERT_EQ(shape.ranges.size(), 1u);
  EXPECT_EQ(shape.ranges[0].maximum, 2);
  EXPECT_EQ(shape.traits, (std::vector<float>{0.5F, 0.25F}));
  ASSERT_EQ(known->differences.size(), 2u);
  const KnownDifference& difference = known->differences.at({{{1, 4}, 9}, 0xfedcba9876543210U});
  EXPECT_EQ(difference.size, 1.25);
  EXPECT_EQ(difference.shape.of_99, 2);
  EXPECT_EQ(difference.fields[1].mean, 7);

  const absl::Status dropped = store->Transact(
      [&](store::Transaction& transaction) { return DropShapes(transaction, "build"); });
  ASSERT_TRUE(dropped.ok()) << dropped;
  EXPECT_TRUE(LoadShapes(*store, "build")->empty());
  EXPECT_FALSE(LoadShapes(*store, "build2")->empty());
}

TEST(KeptShapesTest, IsNotThatOfAnotherVersionButGoesWithIt) {
  const mortise::testing::TemporaryFolder folder;
  const auto store =
      store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string()}).value();
  const absl::Status put = store->Transact(
      [](store::Transaction& transaction) { return PutShapes(transaction, "build", Some(0)); });
  ASSERT_TRUE(put.ok()) << put;
  testing::MakeOld(*store, "mapShapes", "build");
  EXPECT_EQ(testing::RecordsOf(*store, "mapShapes", "build").size(), 2u);
  EXPECT_TRUE(LoadShapes(*store, "build")->empty());
  const absl::Status dropped = store->Transact(
      [](store::Transaction& transaction) { return DropShapes(transaction, "build"); });
  ASSERT_TRUE(dropped.ok()) << dropped;
  EXPECT_TRUE(testing::RecordsOf(*store, "mapShapes", "build").empty());
}

}  // namespace
}  // namespace mortise::interpolator
