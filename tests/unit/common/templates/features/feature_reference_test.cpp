// References to faces and edges: how they are read, and that they mean the same when what is around
// them changes, or say why they no longer can.
#include "common/templates/features/feature_reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "common/base/errors.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::cad {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

TEST(FeatureReference, IsRead) {
  EXPECT_EQ(*ParseFaceReference("plate"), (FaceName{"plate", kNoInstance, ""}));
  EXPECT_EQ(*ParseFaceReference(" plate.outline.right "),
            (FaceName{"plate", kNoInstance, "outline.right"}));
  EXPECT_EQ(*ParseFaceReference("holes[12].wall"), (FaceName{"holes", 12, "wall"}));
  EXPECT_EQ(*ParseFaceReference("holes[*]"), (FaceName{"holes", kEveryInstance, ""}));
  const auto edge = ParseEdgeReference("a.start & b[2].hex.3");
  ASSERT_TRUE(edge.ok()) << edge.status();
  EXPECT_EQ(ToString(edge->face), "a.start");
  EXPECT_EQ(ToString(*edge->other), "b[2].hex.3");
  EXPECT_FALSE(ParseEdgeReference("a.start & *")->other.has_value());
}

TEST(FeatureReference, IsRefused) {
  for (const char* text : {"", ".", "1a", "a.", "a..b", "a[", "a[x]", "a[-1]", "a[99999999999].b",
                           "a[1]b", "a b", "a & b", "*"}) {
    EXPECT_FALSE(ParseFaceReference(text).ok()) << text;
  }
  for (const char* text : {"", "a", "&", "a &", "& a", "* & a", "a & b & c"}) {
    EXPECT_FALSE(ParseEdgeReference(text).ok()) << text;
  }
  EXPECT_FALSE(ParseFaceReference(std::string(1000, 'a')).ok());
}

// The edge along the right of the block is bevelled; a slot moves across it and splits it.
TEST(PersistentReference, SurvivesASlotThatMovesAcrossAnEdge) {
  const auto model = ModelOf(TemplateText(
      Range("x", -0.02, 0.06, 0),
      BlockText() +
          "features { name: 'slot_sketch' sketch { profiles { name: 'slot' rectangle { center { x: "
          "'x' } width: '0.03' height: '0.02' } } } } "
          "features { name: 'slot' extrude { sketch: 'slot_sketch' to: '0.02' operation: CUT } } "
          "features { name: 'bevel' chamfer { edges: 'block.outline.right & block.end' distance: "
          "'0.002' } } "
          "features { name: 'held' fixed { faces: 'block.outline.right' } }"));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto at = [&](double x) { return model->Regenerate(Eigen::VectorXd::Constant(1, x)); };

  const auto inside = at(0);  // the slot is a window in the plate
  ASSERT_TRUE(inside.ok()) << inside.status();
  EXPECT_NEAR(inside->solid.Volume(), kBlockVolume - 0.03 * 0.02 * 0.02 - 2e-6 * 0.06, 1e-13);
  EXPECT_EQ(inside->conditions[0].faces.size(), 1U);

  const auto across = at(0.045);  // it opens through the right side: two pieces of edge and face
  ASSERT_TRUE(across.ok()) << across.status();
  EXPECT_NEAR(across->solid.Volume(), kBlockVolume - 0.02 * 0.02 * 0.02 - 2e-6 * 0.04, 1e-13);
  EXPECT_EQ(across->conditions[0].faces.size(), 2U);
  EXPECT_EQ(FacesOf(*across, "bevel")->size(), 2U);
  EXPECT_EQ(FacesOf(*across, "block.outline.right")->size(), 2U);
  EXPECT_EQ(FacesOf(*across, "slot.slot.right")->size(), 0U);
}

TEST(PersistentReference, PatternsMayChangeTheirCount) {
  const std::string text =
      Range("count", 1, 5, 3) + BlockText() +
      "features { name: 'h' hole { face: 'block.end' position { x: '-0.04' } diameter: '0.008' } } "
      "features { name: 'holes' linear_pattern { feature: 'h' step { x: '0.02' } count: "
      "'floor(count)' } } ";
  const auto rims =
      ModelOf(TemplateText(text,
                           "features { name: 'rims' chamfer { edges: 'holes[*].wall & "
                           "block.end' distance: '0.001' } }"));
  ASSERT_TRUE(rims.ok()) << rims.status();
  // A hole, and over it a cone from radius 5 mm to 4 mm instead of a cylinder of 4 mm.
  const double one =
      pi * 0.004 * 0.004 * 0.019 + pi / 3 * 0.001 * (0.005 * 0.005 + 0.005 * 0.004 + 0.004 * 0.004);
  for (const int count : {1, 2, 3, 5}) {
    const auto model = rims->Regenerate(Eigen::VectorXd::Constant(1, count));
    ASSERT_TRUE(model.ok()) << model.status();
    EXPECT_NEAR(model->solid.Volume(), kBlockVolume - count * one, 1e-12);
    EXPECT_EQ(FacesOf(*model, "rims")->size(), static_cast<std::size_t>(count));
    EXPECT_EQ(FacesOf(*model, "holes[*].wall")->size(), static_cast<std::size_t>(count) - 1);
  }

  const auto third =
      ModelOf(TemplateText(text,
                           "features { name: 'rim' chamfer { edges: 'holes[2].wall & "
                           "block.end' distance: '0.001' } }"));
  ASSERT_TRUE(third.ok()) << third.status();
  EXPECT_TRUE(third->Regenerate(Eigen::VectorXd::Constant(1, 3)).ok());
  const auto broken = third->Regenerate(Eigen::VectorXd::Constant(1, 2));
  EXPECT_EQ(DetailOf(broken.status()).field, "features[4].chamfer.edges[0]");
  EXPECT_THAT(std::string(broken.status().message()),
              HasSubstr("there is no 'holes[2].wall': the pattern has 2 instances"));
}

TEST(PersistentReference, MergedFacesKeepBothNames) {
  const auto model = SolidOf(
      "", BlockText() +
              "features { name: 'wing_sketch' sketch { profiles { name: 'o' rectangle { center { "
              "x: '0.07' } width: '0.06' height: '0.06' } } } } features { name: 'wing' extrude { "
              "sketch: 'wing_sketch' to: '0.02' operation: UNITE } } features { name: 'h' hole { "
              "face: 'wing.end' position { x: '-0.03' } diameter: '0.01' } }");
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(*FacesOf(*model, "block.end"), *FacesOf(*model, "wing.end"));
  EXPECT_EQ(FacesOf(*model, "block.end")->size(), 1U);
  EXPECT_EQ(model->origins.size(), 7U);  // a box with a hole
}

TEST(PersistentReference, SaysWhichFeatureRemovedAFace) {
  const auto model = ModelOf(TemplateText(
      Range("depth", 0.01, 0.12, 0.02),
      BlockText() +
          "features { name: 'saw_sketch' sketch { profiles { name: 'o' rectangle { center { x: "
          "'0.05' } width: 'depth' height: '0.1' } } } } features { name: 'saw' extrude { sketch: "
          "'saw_sketch' from: '-0.01' to: '0.03' operation: CUT } } features { name: 'rim' fillet "
          "{ edges: 'block.outline.right & block.end' radius: '0.001' } }"));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto solid = model->Regenerate(model->Defaults());
  EXPECT_EQ(DetailOf(solid.status()).field, "features[4].fillet.edges[0]");
  EXPECT_THAT(std::string(solid.status().message()),
              HasSubstr("face 'block.outline.right' was removed by 'saw'"));
}

TEST(PersistentReference, SaysThatFacesDoNotMeet) {
  const auto solid = SolidOf("", BlockText() +
                                     "features { name: 'rim' fillet { edges: 'block.outline.right "
                                     "& block.outline.left' radius: '0.001' } }");
  EXPECT_EQ(DetailOf(solid.status()).field, "features[2].fillet.edges[0]");
  EXPECT_THAT(std::string(solid.status().message()),
              HasSubstr("faces 'block.outline.right' and 'block.outline.left' do not meet"));
}

TEST(PersistentReference, ConditionWhoseFacesGoIsAnError) {
  const auto solid = SolidOf(
      "",
      BlockText() +
          "features { name: 'held' fixed { faces: 'block.end' } } features { name: 's' sketch { "
          "plane { origin { z: '0.01' } } profiles { name: 'o' rectangle { width: '1' height: "
          "'1' } } } } features { name: 'mill' extrude { sketch: 's' to: '0.1' operation: CUT } "
          "}");
  EXPECT_EQ(DetailOf(solid.status()).field, "features[2]");
  EXPECT_THAT(std::string(solid.status().message()), HasSubstr("removed all faces of 'held'"));
}

TEST(Conditions, AreExpressionsToo) {
  const auto model = ModelOf(TemplateText(
      "parameters { name: 'swing' unit: 'rad' minimum: -1 maximum: 1 default_value: 0 } ",
      BlockText() +
          "features { name: 'held' fixed { faces: 'block.start' } } "
          "features { name: 'pull' force { faces: 'block.end' force { x: '500 * sin(swing)' z: "
          "'-500 * cos(swing)' } } } "
          "features { name: 'wind' pressure { faces: 'block.outline.left' pressure: '120' } } "
          "features { name: 'warm' heat { faces: 'block.outline.right' flux: '2000' } } "
          "features { name: 'cool' heat { faces: 'block.outline.top' temperature: '293.15' } }"));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto solid = model->Regenerate(Eigen::VectorXd::Constant(1, 0.5));
  ASSERT_TRUE(solid.ok()) << solid.status();
  ASSERT_EQ(solid->conditions.size(), 5U);
  EXPECT_EQ(solid->conditions[0].kind, parametric::BoundaryConditionKind::kFixed);
  EXPECT_EQ(solid->conditions[0].faces, *FacesOf(*solid, "block.start"));
  EXPECT_TRUE(solid->conditions[1].force.isApprox(
      Eigen::Vector3d(500 * std::sin(0.5), 0, -500 * std::cos(0.5)), 1e-12));
  EXPECT_EQ(solid->conditions[2].pressure, 120);
  EXPECT_EQ(solid->conditions[3].kind, parametric::BoundaryConditionKind::kHeatFlux);
  EXPECT_EQ(solid->conditions[3].heat_flux, 2000);
  EXPECT_EQ(solid->conditions[4].kind, parametric::BoundaryConditionKind::kTemperature);
  EXPECT_EQ(solid->conditions[4].temperature, 293.15);
}

}  // namespace
}  // namespace mortise::cad
