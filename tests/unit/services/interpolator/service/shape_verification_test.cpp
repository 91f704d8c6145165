// How far a map's shapes and fields are found to be off true designs.
#include "services/interpolator/service/shape_verification.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/services/interpolator/service/stored_bars.h"

namespace mortise::interpolator {
namespace {

using testing::BarDesign;
using testing::StoredBars;

// Of the map's place (0.25, 0.5).
v1::MapVerification Verified(const LoadedMap& map, LoadedShapes& shapes,
                             const std::vector<fields::DesignFields>& truths) {
  ShapeVerification verification(map, shapes);
  for (const fields::DesignFields& truth : truths) {
    const auto compared = verification.Compare(0, Eigen::Vector2d(0.25, 0.5), truth);
    EXPECT_TRUE(compared.ok() && *compared) << compared.status();
  }
  v1::MapVerification found;
  verification.Report(found);
  return found;
}

// A bar whose elements are others and that consists of two parts.
fields::DesignFields BarOfTwoParts() {
  fields::DesignFields bar = BarDesign(0.25, 11, 4);
  bar.parts.push_back("other");
  return bar;
}

TEST(ShapeVerificationTest, SaysHowManyDesignsHaveNoFiguresOfFields) {
  StoredBars bars;
  const auto map = bars.map();
  const v1::MapVerification one =
      Verified(*map, bars.shapes(), {BarDesign(0.25, 11), BarOfTwoParts()});
  EXPECT_EQ(one.unmapped(), 1);
  ASSERT_EQ(one.shapes_size(), 3);
  EXPECT_LT(one.shapes(0).largest(), 1e-3);
  EXPECT_EQ(one.shapes(2).field(), "heat");
  EXPECT_LT(one.shapes(2).largest(), 1e-5);
  const v1::MapVerification none = Verified(*map, bars.shapes(), {BarOfTwoParts()});
  EXPECT_EQ(none.unmapped(), 1);
  EXPECT_EQ(none.shapes_size(), 1);
}

TEST(ShapeVerificationTest, SaysHowManyDesignsTheMapHasNoShapeOf) {
  for (const auto has : {StoredBars::Has::kMetrics, StoredBars::Has::kNothing}) {
    StoredBars bars(3, has);
    const auto map = bars.map();
    ShapeVerification verification(*map, bars.shapes());
    for (int i = 0; i < 2; ++i) {
      const auto compared =
          verification.Compare(0, Eigen::Vector2d(0.25, 0.5), BarDesign(0.25, 11));
      EXPECT_TRUE(compared.ok() && !*compared) << compared.status();
    }
    v1::MapVerification found;
    verification.Report(found);
    EXPECT_EQ(found.shapeless(), has == StoredBars::Has::kMetrics ? 2 : 0);
    EXPECT_EQ(found.unmapped(), 0);
    EXPECT_EQ(found.shapes_size(), 0);
  }
}

TEST(ShapeVerificationTest, TellsOfFieldsThatAreConstantInTheMapAlone) {
  StoredBars bars;
  LoadedMap map{bars.map()->record, bars.map()->structures, bars.map()->shapes};
  v1::MapShapes::Field& heat = *map.record.mutable_shapes()->mutable_fields(1);
  heat.set_minimum(0.25);
  heat.set_maximum(0.25);
  fields::DesignFields truth = BarDesign(0.25, 11);
  EXPECT_EQ(Verified(map, bars.shapes(), {truth}).shapes(2).largest(), 0);
  // Of one element.
  truth.fields[1].values(0, 5) = 1.25;
  const v1::MapVerification varies = Verified(map, bars.shapes(), {truth});
  EXPECT_NEAR(varies.shapes(2).largest(), 1, 1e-4);
  EXPECT_NEAR(varies.shapes(2).mean(), 1.0 / 18, 1e-4);
  // Constant too, but another number.
  truth.fields[1].values.setConstant(3);
  EXPECT_NEAR(Verified(map, bars.shapes(), {truth}).shapes(2).mean(), 1, 1e-4);
}

TEST(ShapeVerificationTest, OrdersPlacesByTheirMesh) {
  StoredBars bars;
  const auto map = bars.map();
  LoadedMap two{
      map->record, {map->structures[0], map->structures[0]}, {map->shapes[0], map->shapes[0]}};
  const ShapeVerification verification(two, bars.shapes());
  Eigen::Matrix2Xd places(2, 4);
  places << 0.5, 0.1, 0.9, 0.2, 0.5, 0.1, 0.9, 0.2;
  EXPECT_EQ(verification.OrderByMesh({1, 0, 1, 0}, places), (std::vector<std::size_t>{1, 3, 0, 2}));
}

}  // namespace
}  // namespace mortise::interpolator
