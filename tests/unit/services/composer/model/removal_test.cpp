// Nodes of models as they are now, taken out.
#include "services/composer/model/removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {
namespace {

Design Cabinet() { return AsDrawn(parametric::ReadShippedAssembly("cabinet").value()).value(); }

TEST(RemovalTest, ADrawerGoesWithItsSlides) {
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly left, WithoutNode(Cabinet(), "left drawer"));
  const auto is_of_drawer = [](const parametric::AssemblyPart& part) {
    return part.name.starts_with("left drawer");
  };
  const parametric::Assembly whole = Cabinet().assembly->assembly();
  EXPECT_EQ(std::count_if(left.parts.begin(), left.parts.end(), is_of_drawer), 0);
  EXPECT_EQ(left.parts.size() + std::count_if(whole.parts.begin(), whole.parts.end(), is_of_drawer),
            whole.parts.size());
  EXPECT_EQ(left.joints.size(), 3U);
  ASSERT_OK_AND_ASSIGN(const Design model, AsDrawn(left));
  EXPECT_FALSE(model.assembly->AdjustableSizes()->empty());
}

// Its box lies on the tips of the screws that hold the axle to the shafts.
TEST(RemovalTest, TheAxleOfACartStaysHeldWithoutItsBox) {
  const Design cart = AsDrawn(parametric::ReadShippedAssembly("garden_cart").value()).value();
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly left, WithoutNode(cart, "box"));
  const auto count = [&](const std::string& name) {
    return std::count_if(left.parts.begin(), left.parts.end(),
                         [&](const auto& part) { return part.name.starts_with(name); });
  };
  EXPECT_EQ(count("axle beam screw"), 2);
  EXPECT_EQ(count("floor"), 0);
}

TEST(RemovalTest, ItIsTakenOutOfTheDesignAsItIsNow) {
  Design design = Cabinet();
  ASSERT_OK_AND_ASSIGN(const parametric::Adjustment wider,
                       design.assembly->Adjust(design.q, {{{"top", Axis::kX}, 1.2}},
                                               parametric::DemandPolicy::kStrict));
  design.q = wider.q;
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly left, WithoutNode(design, "right door"));
  for (const parametric::AssemblyPart& part : left.parts) {
    if (part.name == "top") {
      EXPECT_NEAR(part.box.size().x(), 1.2, 1e-9);
    }
  }
}

// The planks of a bench of which the bearers go.
TEST(RemovalTest, WhatNothingHoldsAnyMoreStaysWhereItIs) {
  for (const auto& [id, node, loose] :
       {std::tuple("coat_rack", "board", "bracket 1"),
        std::tuple("coat_rack", "hat shelf", "bracket 2"),
        std::tuple("picnic_table", "front bench plank 1", "front bench plank 3")}) {
    SCOPED_TRACE(id);
    const Design whole = AsDrawn(parametric::ReadShippedAssembly(id).value()).value();
    const std::vector<parametric::PlacedPart> before = PartsOf(whole);
    ASSERT_OK_AND_ASSIGN(const parametric::Assembly left, WithoutNode(whole, node));
    ASSERT_OK_AND_ASSIGN(const Design model, AsDrawn(left));
    ASSERT_OK_AND_ASSIGN(const auto open, model.assembly->feasible_set().UnboundedDirection());
    EXPECT_FALSE(open.has_value());
    const auto place_in = [&](const std::vector<parametric::PlacedPart>& parts) {
      const auto found = std::find_if(parts.begin(), parts.end(),
                                      [&](const auto& part) { return part.name == loose; });
      return found == parts.end() ? Eigen::Vector3d::Zero().eval() : found->box.center();
    };
    EXPECT_LT((place_in(PartsOf(model)) - place_in(before)).norm(), 1e-9);
  }
}

TEST(RemovalTest, ANodeThereIsNotIsRefused) {
  const absl::Status refused = WithoutNode(Cabinet(), "cellar").status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(refused).field, "node");
}

}  // namespace
}  // namespace mortise::composer
