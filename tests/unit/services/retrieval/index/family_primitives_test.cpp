#include "services/retrieval/index/family_primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/services/retrieval/index/random_covers.h"

namespace mortise::retrieval {
namespace {

class FamilyPrimitivesTest : public ::testing::Test {
 protected:
  FamilyPrimitivesTest() {
    covers_ = testing::RandomCovers({.families = 5, .primitives = 30}, &random_);
    query_.descriptors = {testing::RandomDescriptor(24, &random_),
                          testing::RandomDescriptor(24, &random_)};
    query_.count = 4;
  }

  double DistanceOf(const Primitive& primitive) const {
    return std::min(Distance(primitive, query_.descriptors[0]),
                    Distance(primitive, query_.descriptors[1]));
  }

  Random random_{7};
  std::vector<FamilyCover> covers_;
  IndexQuery query_;
};

TEST_F(FamilyPrimitivesTest, AreThoseThatLookingAtEachFinds) {
  const auto index = PrimitiveIndex::Build(covers_);
  ASSERT_TRUE(index.ok()) << index.status();
  const auto found = NearestOfFamily(*index, query_, 3);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_GE(found->size(), 4u);
  std::vector<double> distances;
  for (const Primitive& each : covers_[3].primitives) distances.push_back(DistanceOf(each));
  std::sort(distances.begin(), distances.end());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR((*found)[i].distance, distances[i], 1e-5);
    EXPECT_EQ((*found)[i].family, 3);
    EXPECT_EQ(index->PrimitiveOf((*found)[i]).parameters,
              covers_[3].primitives[std::size_t((*found)[i].primitive)].parameters);
  }
}

TEST_F(FamilyPrimitivesTest, HaveEachStructureAmongThem) {
  // The first structure's primitives are the nearest.
  for (Primitive& each : covers_[2].primitives) {
    if (each.structure == 1) each.center.array() += 50;
  }
  const auto index = PrimitiveIndex::Build(covers_);
  ASSERT_TRUE(index.ok()) << index.status();
  const auto found = NearestOfFamily(*index, query_, 2);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(index->PrimitiveOf((*found)[i]).structure, i < 4 ? 0 : 1);
  }
}

TEST_F(FamilyPrimitivesTest, AreNoneOfAFamilyThatIsNotThere) {
  const auto index = PrimitiveIndex::Build(covers_);
  ASSERT_TRUE(index.ok()) << index.status();
  EXPECT_TRUE(NearestOfFamily(*index, query_, 77)->empty());
  query_.descriptors.emplace_back(Eigen::VectorXd::Zero(3));
  EXPECT_EQ(DetailOf(NearestOfFamily(*index, query_, 3).status()).field, "descriptors");
  query_.count = 0;
  EXPECT_EQ(DetailOf(NearestOfFamily(*index, query_, 3).status()).field, "count");
}

}  // namespace
}  // namespace mortise::retrieval
