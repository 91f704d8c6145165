// What people sit, stand and put things on.
#include "services/composer/holding/bearing_surfaces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::FixedPart;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Assembly OneBoard(const std::string& name, double height) {
  return parametric::Named("model", {FixedPart(name, {0, 0, height - 0.02}, {0.4, 0.4, height})});
}

TEST(BearingSurfacesTest, ATopByItsName) {
  const auto found = FindBearingSurfaces(parametric::TwoLeggedTable(), 0);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].kind, BearingKind::kTop);
  EXPECT_THAT(found[0].parts, ElementsAre("top"));
  EXPECT_EQ(found[0].box.minimum, Eigen::Vector3d(-0.5, 0, 0.74));
  EXPECT_EQ(found[0].box.maximum, Eigen::Vector3d(0.5, 0.4, 0.74));
  EXPECT_NEAR(found[0].area, 0.4, 1e-12);
  EXPECT_EQ(found[0].Load(), 1000);
}

TEST(BearingSurfacesTest, AShelfBearsByItsArea) {
  const auto found = FindBearingSurfaces(OneBoard("shelf 2", 1), 0);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].kind, BearingKind::kShelf);
  EXPECT_NEAR(found[0].Load(), 160, 1e-9);
}

TEST(BearingSurfacesTest, TheSlatsOfASeatAreOneByTheNameOfTheirGroup) {
  Assembly bench;
  bench.name = "bench";
  bench.groups = {{"model", -1}, {"garden seat", 0}, {"slats", 1}};
  for (int i = 0; i < 5; ++i) {
    bench.parts.push_back(FixedPart("slat " + std::to_string(i + 1), {0, 0.1 * i, 0.4},
                                    {1.2, 0.1 * i + 0.07, 0.42}, 2));
  }
  const auto found = FindBearingSurfaces(bench, 0);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].kind, BearingKind::kSeat);
  EXPECT_THAT(found[0].parts, SizeIs(5));
  EXPECT_NEAR(found[0].area, 5 * 1.2 * 0.07, 1e-12);
  EXPECT_EQ(found[0].because, "by the name of its group 'garden seat'");
  // Two rails far from each other are none.
  bench.parts = {bench.parts.front(), bench.parts.back()};
  EXPECT_THAT(FindBearingSurfaces(bench, 0), IsEmpty());
}

TEST(BearingSurfacesTest, WhatHasNoTellingNameGoesByItsHeight) {
  const auto kind_at = [](double height, double floor) {
    const auto found = FindBearingSurfaces(OneBoard("board", height), floor);
    EXPECT_THAT(found, SizeIs(1));
    return found.at(0).kind;
  };
  EXPECT_EQ(kind_at(0.45, 0), BearingKind::kSeat);
  EXPECT_EQ(kind_at(0.45, 0.3), BearingKind::kTop);
  EXPECT_EQ(kind_at(0.75, 0), BearingKind::kTop);
  Assembly two = OneBoard("board", 0.45);
  two.parts.push_back(FixedPart("roofing", {0, 0, 0.8}, {0.4, 0.4, 0.82}));
  const auto found = FindBearingSurfaces(two, 0);
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].kind, BearingKind::kShelf);
  EXPECT_EQ(found[1].kind, BearingKind::kTop);
}

TEST(BearingSurfacesTest, WhatIsCoveredUprightSmallOrABackIsNone) {
  Assembly covered = OneBoard("bearer", 0.7);
  covered.parts.push_back(FixedPart("top", {0, 0, 0.7}, {0.4, 0.4, 0.72}));
  EXPECT_THAT(FindBearingSurfaces(covered, 0), SizeIs(1));
  const Assembly upright =
      parametric::Named("model", {FixedPart("shelf", {0, 0, 0}, {0.4, 0.02, 0.4})});
  EXPECT_THAT(FindBearingSurfaces(upright, 0), IsEmpty());
  const Assembly small =
      parametric::Named("model", {FixedPart("shelf", {0, 0, 0}, {0.4, 0.09, 0.02})});
  EXPECT_THAT(FindBearingSurfaces(small, 0), IsEmpty());
  EXPECT_THAT(FindBearingSurfaces(OneBoard("left side", 0.45), 0), IsEmpty());
}

}  // namespace
}  // namespace mortise::composer
