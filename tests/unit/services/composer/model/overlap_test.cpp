// How deep parts reach into each other.
#include "services/composer/model/overlap.h"

#include <gtest/gtest.h>

#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

SolidPart Box(const Eigen::Vector3d& minimum, const Eigen::Vector3d& maximum) {
  return SolidPart("box", {minimum, maximum}, nullptr, mesh::BoxStretch(maximum - minimum));
}

TEST(OverlapTest, BoxesByHowFarOneMustBeMoved) {
  const SolidPart box = Box({0, 0, 0}, {1, 1, 1});
  EXPECT_NEAR(SolidPart::DepthOf(box, Box({0.9, 0.5, 0.5}, {2, 2, 2})), 0.1, 1e-12);
  EXPECT_NEAR(SolidPart::DepthOf(box, Box({0.4, 0.4, 0.4}, {0.5, 0.5, 0.5})), 0.5, 1e-12);
  EXPECT_EQ(SolidPart::DepthOf(box, Box({1, 0, 0}, {2, 1, 1})), 0);
  EXPECT_EQ(SolidPart::DepthOf(box, Box({0.99995, 0, 0}, {2, 1, 1})), 0);
  EXPECT_EQ(SolidPart::DepthOf(box, Box({1.1, 0, 0}, {2, 1, 1})), 0);
}

// An angle bracket leaves the middle of its box free.
TEST(OverlapTest, ShapesByWhatTheyFill) {
  const Design& table = ShippedDesign("dining_table");
  for (const parametric::AssemblyPart& part : table.assembly->assembly().parts) {
    if (part.name != "bracket front 1") continue;
    const SolidPart bracket(part);
    const auto around = [&](const Eigen::Vector3d& middle) {
      return Box(middle - Eigen::Vector3d::Constant(0.002),
                 middle + Eigen::Vector3d::Constant(0.002));
    };
    EXPECT_EQ(SolidPart::DepthOf(bracket, around(part.box.center())), 0);
    Eigen::Vector3d corner = part.box.center();
    corner.z() = part.box.maximum.z() - 0.001;
    corner.y() = part.box.minimum.y() + 0.001;
    EXPECT_GT(SolidPart::DepthOf(bracket, around(corner)), 0.0005);
  }
}

TEST(OverlapTest, LengthsForPeopleAreRounded) {
  EXPECT_EQ(Millimetres(0.00325), "3.25 mm");
  EXPECT_EQ(Millimetres(0.004 + 1e-12), "4 mm");
  EXPECT_EQ(Millimetres(0.0123456), "12.35 mm");
  EXPECT_EQ(Millimetres(0), "0 mm");
}

}  // namespace
}  // namespace mortise::composer
