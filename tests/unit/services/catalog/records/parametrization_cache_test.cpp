// Assemblies that are parametrised once: for whoever asks, but not without their shapes.
#include "services/catalog/records/parametrization_cache.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <string>

#include "common/assembly/codec/assembly_codec.h"
#include "common/base/errors.h"
#include "services/catalog/records/shape_records.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {
namespace {

using ::testing::HasSubstr;

bool Stays() { return false; }

// A pyramid on a board, with its shape.
v1::AssemblyBundle PyramidOnBoard() {
  mesh::SurfaceMesh pyramid;
  pyramid.vertices.resize(3, 4);
  pyramid.vertices << 0, 0.03, 0, 0, 0, 0, 0.03, 0, 0, 0, 0, 0.03;
  pyramid.triangles.resize(3, 4);
  pyramid.triangles << 0, 0, 1, 0, 2, 1, 2, 3, 1, 3, 3, 2;
  v1::AssemblyBundle bundle;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "name: 'assemblies/pyramid' parts { name: 'board' position { z: -0.01 } "
      "size { x: 0.03 y: 0.03 z: 0.01 } } "
      "parts { name: 'pyramid' size { x: 0.03 y: 0.03 z: 0.03 } }",
      bundle.mutable_assembly()));
  *bundle.add_shapes() = NamedShape(mesh::ShapeOfMesh(pyramid).value());
  bundle.mutable_assembly()->mutable_parts(1)->set_shape(bundle.shapes(0).name());
  bundle.mutable_assembly()->set_digest(parametric::BundleDigest(bundle));
  return bundle;
}

v1::AssemblyBundle WithoutShapes(v1::AssemblyBundle bundle) {
  bundle.clear_shapes();
  return bundle;
}

class ParametrizationCacheTest : public ::testing::Test {
 protected:
  const v1::AssemblyBundle whole_ = PyramidOnBoard();
  const v1::AssemblyBundle bare_ = WithoutShapes(whole_);
  ParametrizationCache cache_{std::size_t{64} << 20};
};

TEST_F(ParametrizationCacheTest, GivesAllTheSame) {
  ASSERT_OK_AND_ASSIGN(const auto first, cache_.Get(whole_, Stays));
  ASSERT_OK_AND_ASSIGN(const auto second, cache_.Get(whole_, Stays));
  EXPECT_EQ(first, second);
  ASSERT_OK_AND_ASSIGN(const auto third, cache_.ForTemplates()(whole_, Stays, ""));
  EXPECT_EQ(first, third);
}

// The digest is that of the same bundle with its shapes, which somebody has asked for before.
TEST_F(ParametrizationCacheTest, ABundleThatLacksShapesIsToldSoThoughTheAnswerIsKnown) {
  ASSERT_EQ(parametric::BundleDigest(bare_), parametric::BundleDigest(whole_));
  for (const bool is_known : {false, true}) {
    const absl::Status refused = cache_.Get(bare_, Stays).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << is_known;
    EXPECT_EQ(DetailOf(refused).field, "parts[1].shape") << is_known;
    EXPECT_THAT(std::string(refused.message()), HasSubstr("there is no shape"));
    EXPECT_OK(cache_.Get(whole_, Stays));
  }
}

TEST_F(ParametrizationCacheTest, AddsWhatABundleLacksOnlyWhereTheAnswerIsNotKnown) {
  int times = 0;
  const auto complete = [&](v1::AssemblyBundle& bundle) {
    ++times;
    *bundle.mutable_shapes() = whole_.shapes();
    return absl::OkStatus();
  };
  ASSERT_OK_AND_ASSIGN(const auto first, cache_.Get(bare_, Stays, complete));
  ASSERT_OK_AND_ASSIGN(const auto second, cache_.Get(bare_, Stays, complete));
  EXPECT_EQ(first, second);
  EXPECT_EQ(times, 1);
}

// A sub-tree is another assembly than the whole, and is made once, too.
TEST_F(ParametrizationCacheTest, KeepsSubTreesBesideTheWhole) {
  ASSERT_OK_AND_ASSIGN(const auto whole, cache_.Get(whole_, Stays));
  ASSERT_OK_AND_ASSIGN(const auto board, cache_.Get(whole_, Stays, "board"));
  EXPECT_EQ(whole->elements().size(), 2U);
  ASSERT_EQ(board->elements().size(), 1U);
  EXPECT_EQ(board->elements()[0].name, "board");
  ASSERT_OK_AND_ASSIGN(const auto again, cache_.ForTemplates()(whole_, Stays, "board"));
  EXPECT_EQ(again, board);
  EXPECT_EQ(DetailOf(cache_.Get(whole_, Stays, "lid").status()).field, "group");
}

TEST_F(ParametrizationCacheTest, WhoLeavesGetsNothingAndLeavesNothing) {
  const absl::Status left = cache_.Get(whole_, [] { return true; }).status();
  EXPECT_EQ(left.code(), absl::StatusCode::kCancelled);
  EXPECT_OK(cache_.Get(whole_, Stays));
}

}  // namespace
}  // namespace mortise::catalog
