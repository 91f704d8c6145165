// Cuts that follow each other are made in one operation of the kernel. What comes of them, what
// their faces are called, and what is said of one that cannot be made is as if each were made in
// its turn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::cad {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

// Takes a box away: x0 to x1 and all of y, z0 to z1, m.
std::string Sawn(const std::string& name, const std::string& x0, const std::string& x1, double z0,
                 double z1) {
  return absl::StrCat("features { name: '", name,
                      "_sketch' sketch { profiles { name: 'o' rectangle { center { x: '(", x0,
                      " + ", x1, ") / 2' } width: '", x1, " - (", x0,
                      ")' height: '0.1' } } } } features { name: '", name, "' extrude { sketch: '",
                      name, "_sketch' from: '", z0, "' to: '", z1, "' operation: CUT } } ");
}

std::string Drilled(const std::string& name, const std::string& face, double x, double y,
                    double diameter, const std::string& depth) {
  return absl::StrCat("features { name: '", name, "' hole { face: '", face, "' position { x: '", x,
                      "' y: '", y, "' } diameter: '", diameter, "' ",
                      depth.empty() ? "" : absl::StrCat("depth: '", depth, "' "), "} } ");
}

std::size_t CountOf(const RegeneratedModel& model, const std::string& reference) {
  return FacesOf(model, reference)->size();
}

// A groove, a hole through it and a blind hole, all from faces of the block.
TEST(CutsInARow, KeepVolumeFacesAndNames) {
  const auto solid = SolidOf("", BlockText() + Sawn("groove", "-0.005", "0.005", 0.015, 0.03) +
                                     Drilled("across", "block.end", 0.005, 0, 0.006, "") +
                                     Drilled("blind", "block.end", 0.03, 0, 0.008, "0.004") +
                                     Drilled("under", "block.start", -0.03, 0, 0.008, "0.004"));
  ASSERT_TRUE(solid.ok()) << solid.status();
  const double half_disc = pi * 0.003 * 0.003 / 2;
  const double gone =
      0.01 * 0.06 * 0.005 + half_disc * 0.015 + half_disc * 0.02 + 2 * pi * 0.004 * 0.004 * 0.004;
  EXPECT_NEAR(solid->solid.Volume(), kBlockVolume - gone, 1e-13);
  EXPECT_EQ(CountOf(*solid, "block.end"), 2U);
  EXPECT_EQ(CountOf(*solid, "groove.start"), 1U);
  EXPECT_EQ(CountOf(*solid, "across.wall"), 1U);
  EXPECT_EQ(CountOf(*solid, "blind.floor"), 1U);
  EXPECT_EQ(CountOf(*solid, "under.wall"), 1U);
  // Of the groove its floor and three walls, for a hole parts one.
  EXPECT_EQ(solid->origins.size(), 7U + 4U + 1U + 2U + 2U);
  for (const auto& names : solid->origins) EXPECT_EQ(names.size(), 1U);
}

// The second cut takes all of the face that it was drawn on, which is no fault of the first.
TEST(CutsInARow, MayTakeTheWholeFaceTheyAreDrawnOn) {
  const auto solid = SolidOf(
      "", BlockText() + Sawn("groove", "-0.005", "0.005", 0.015, 0.03) +
              "features { name: 'top' sketch { plane { face: 'block.end' } profiles { name: 'o' "
              "rectangle { width: '0.2' height: '0.2' } } } } features { name: 'mill' extrude { "
              "sketch: 'top' from: '-0.001' to: '0.001' operation: CUT } } ");
  ASSERT_TRUE(solid.ok()) << solid.status();
  EXPECT_NEAR(solid->solid.Volume(), kBlockVolume * 0.95 - 0.01 * 0.06 * 0.004, 1e-13);
  EXPECT_EQ(CountOf(*solid, "block.end"), 0U);
  EXPECT_EQ(CountOf(*solid, "mill.start"), 2U);
}

TEST(CutsInARow, SayWhichOfThemRemovedAFace) {
  const auto model = ModelOf(
      TemplateText(Range("thickness", 0.001, 0.03, 0.01),
                   BlockText() + Sawn("slot", "0.03", "0.04", 0.015, 0.03) +
                       "features { name: 'cover' sketch { plane { origin { z: 'thickness' } } "
                       "profiles { name: 'o' rectangle { width: '1' height: '1' } } } } "
                       "features { name: 'mill' extrude { sketch: 'cover' to: '0.1' operation: "
                       "CUT } } " +
                       Drilled("bolt", "block.end", 0, 0, 0.008, "")));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto milled = model->Regenerate(model->Defaults());
  EXPECT_EQ(DetailOf(milled.status()).field, "features[6].hole.face");
  EXPECT_THAT(std::string(milled.status().message()),
              HasSubstr("face 'block.end' was removed by 'mill'"));
  const auto whole = model->Regenerate(Eigen::VectorXd::Constant(1, 0.03));
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_EQ(CountOf(*whole, "bolt.wall"), 1U);
}

// Two bosses of one sketch; the saw moves over the first. The hole in the second stays where it is.
TEST(CutsInARow, RelyOnFacesOfWhichSomeAreLeft) {
  const auto model = ModelOf(TemplateText(
      Range("from", -0.04, 0.0, -0.005),
      BlockText() +
          "features { name: 'round' sketch { plane { origin { z: '0.02' } } profiles { name: 'a' "
          "circle { center { x: '-0.03' } radius: '0.01' } } profiles { name: 'b' circle { center "
          "{ x: '0.03' } radius: '0.01' } } } } features { name: 'bosses' extrude { sketch: "
          "'round' to: '0.005' operation: UNITE } } features { name: 'rim' chamfer { edges: "
          "'block.outline & block.start' distance: '0.001' } } " +
          Sawn("saw", "-0.06", "from", 0.02, 0.03) +
          Drilled("bore", "bosses.end", 0.03, 0, 0.008, "") +
          "features { name: 'held' fixed { faces: 'bore.wall' } }"));
  ASSERT_TRUE(model.ok()) << model.status();
  const auto sawn = model->Regenerate(model->Defaults());
  const auto whole = model->Regenerate(Eigen::VectorXd::Constant(1, -0.04));
  ASSERT_TRUE(sawn.ok()) << sawn.status();
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_EQ(CountOf(*whole, "bosses.end"), 2U);
  EXPECT_EQ(CountOf(*sawn, "bosses.end"), 1U);
  EXPECT_EQ(CountOf(*sawn, "bore.wall"), 1U);
  EXPECT_NEAR(whole->solid.Volume() - sawn->solid.Volume(), pi * 0.01 * 0.01 * 0.005, 1e-13);
}

// A drawing on the floors of holes, of which one is made before and the others wait.
TEST(CutsInARow, WaitForFacesThatTheyMakeThemselves) {
  const std::string holes =
      Drilled("h", "block.end", -0.04, 0, 0.008, "0.012") +
      "features { name: 'rim' chamfer { edges: 'h.wall & block.end' distance: '0.001' } } "
      "features { name: 'holes' linear_pattern { feature: 'h' step { x: '0.02' } count: '3' } } ";
  const auto solid =
      SolidOf("", BlockText() + holes + Drilled("tip", "holes[*].floor", -0.02, 0, 0.004, "0.002") +
                      Drilled("last", "tip.floor", -0.02, 0, 0.002, ""));
  ASSERT_TRUE(solid.ok()) << solid.status();
  const double cone =
      pi / 3 * 0.001 * (0.005 * 0.005 + 0.005 * 0.004 + 0.004 * 0.004) - pi * 0.004 * 0.004 * 0.001;
  const double gone = 3 * pi * 0.004 * 0.004 * 0.012 + cone + pi * 0.002 * 0.002 * 0.002 +
                      pi * 0.001 * 0.001 * 0.006;
  EXPECT_NEAR(solid->solid.Volume(), kBlockVolume - gone, 1e-13);
  EXPECT_EQ(CountOf(*solid, "h.floor"), 1U);
  EXPECT_EQ(CountOf(*solid, "holes[*].floor"), 2U);
  EXPECT_EQ(CountOf(*solid, "tip.floor"), 1U);
  EXPECT_EQ(CountOf(*solid, "last.wall"), 1U);
}

}  // namespace
}  // namespace mortise::cad
