// Controls of nodes of the designs that ship, and dragging them.
#include "services/composer/model/controls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "common/base/errors.h"
#include "services/composer/model/placed_forms.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;

std::optional<Control> Find(const std::vector<Control>& controls, ControlKind kind, Axis axis) {
  for (const Control& control : controls) {
    if (control.kind == kind && control.axis == axis) return control;
  }
  return std::nullopt;
}

BoundingBox BoxOfNode(const Design& design, const std::string& node) {
  const auto names = parametric::PartsOfNode(design.assembly->assembly(), node).value();
  std::optional<BoundingBox> box;
  for (const PrincipalPart& part : PrincipalPartsOf(design)) {
    if (std::find(names.begin(), names.end(), part.drawn_as) == names.end()) continue;
    if (!box) box = part.box;
    box->minimum = box->minimum.cwiseMin(part.box.minimum);
    box->maximum = box->maximum.cwiseMax(part.box.maximum);
  }
  return box.value();
}

TEST(ControlsTest, ABoardOfOneThicknessHasNoControlForIt) {
  const Design& shelf = ShippedDesign("bookshelf");
  ASSERT_OK_AND_ASSIGN(const std::vector<Control> side, ControlsOf(shelf, "side 1"));
  EXPECT_FALSE(Find(side, ControlKind::kSize, Axis::kX).has_value());
  ASSERT_TRUE(Find(side, ControlKind::kSize, Axis::kY).has_value());
  const std::optional<Control> height = Find(side, ControlKind::kSize, Axis::kZ);
  ASSERT_TRUE(height.has_value());
  EXPECT_NEAR(height->value, 1.8, 1e-9);
  EXPECT_LT(height->minimum, 1.7);
  EXPECT_GT(height->maximum, 1.9);
}

TEST(ControlsTest, TheWholeStaysInItsPlace) {
  ASSERT_OK_AND_ASSIGN(const std::vector<Control> whole,
                       ControlsOf(ShippedDesign("bookshelf"), ""));
  EXPECT_FALSE(Find(whole, ControlKind::kCenter, Axis::kX).has_value());
  EXPECT_FALSE(Find(whole, ControlKind::kCenter, Axis::kY).has_value());
  EXPECT_TRUE(Find(whole, ControlKind::kSize, Axis::kX).has_value());
}

TEST(ControlsTest, WhatIsNotThereIsRefused) {
  const Design& shelf = ShippedDesign("bookshelf");
  EXPECT_EQ(DetailOf(ControlsOf(shelf, "cellar").status()).field, "node");
  EXPECT_EQ(DetailOf(Drag(shelf, "cellar", ControlKind::kSize, Axis::kX, 1).status()).field,
            "node");
  EXPECT_EQ(DetailOf(Drag(shelf, "side 1", ControlKind::kSize, Axis::kX, 1).status()).field,
            "control");
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(DetailOf(Drag(shelf, "side 1", ControlKind::kSize, Axis::kZ, none).status()).field,
            "value");
}

class ShippedControlsTest : public ::testing::TestWithParam<std::string> {};

// Whatever is dragged wherever: the node gets there as far as it can, and all holds to 1e-9 m.
TEST_P(ShippedControlsTest, WhatIsDraggedGetsThereOrToTheEnd) {
  const Design& design = ShippedDesign(GetParam());
  std::vector<std::string> nodes = {""};
  for (std::size_t i = 1; i < design.assembly->assembly().groups.size() && i < 3; ++i) {
    nodes.push_back(design.assembly->assembly().groups[i].name);
  }
  int dragged = 0;
  for (const std::string& node : nodes) {
    ASSERT_OK_AND_ASSIGN(const std::vector<Control> controls, ControlsOf(design, node));
    for (const Control& control : controls) {
      EXPECT_GE(control.value, control.minimum - 1e-8);
      EXPECT_LE(control.value, control.maximum + 1e-8);
      for (const double value :
           {control.minimum + 0.3 * (control.maximum - control.minimum), control.maximum + 0.5}) {
        ASSERT_OK_AND_ASSIGN(const Design there,
                             Drag(design, node, control.kind, control.axis, value));
        ++dragged;
        EXPECT_TRUE(there.assembly->feasible_set().Violations(there.q, 1e-9).empty());
        const BoundingBox box = BoxOfNode(there, node);
        const int axis = static_cast<int>(control.axis);
        // Where another element has come to bound the node, the box is larger than the form says.
        const double reached =
            control.kind == ControlKind::kSize ? box.size()[axis] : box.center()[axis];
        if (control.kind == ControlKind::kSize) {
          EXPECT_GE(reached, std::min(value, control.maximum) - 1e-7) << node;
        }
      }
    }
  }
  EXPECT_GT(dragged, 0);
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedControlsTest,
                         ::testing::Values("bookshelf", "dining_table", "toy_chest", "tool_cart",
                                           "garden_bench", "workbench"),
                         [](const auto& shipped) { return shipped.param; });

// The thesis: the first term counts, the second only chooses among what meets it.
TEST(ControlsTest, ALeafIsAsLargeAsItIsDragged) {
  const Design& shelf = ShippedDesign("bookshelf");
  ASSERT_OK_AND_ASSIGN(const Design higher,
                       Drag(shelf, "side 1", ControlKind::kSize, Axis::kZ, 2.0));
  EXPECT_NEAR(BoxOfNode(higher, "side 1").size().z(), 2.0, 1e-9);
  EXPECT_NEAR(BoundsOf(higher).minimum.z(), 0, 1e-9);
  EXPECT_NEAR(BoundsOf(higher).center().x(), BoundsOf(shelf).center().x(), 1e-9);
  // What the drag does not ask for stays.
  EXPECT_NEAR(BoundsOf(higher).size().x(), 0.9, 1e-9);
}

}  // namespace
}  // namespace mortise::composer
