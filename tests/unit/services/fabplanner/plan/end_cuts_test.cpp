#include "services/fabplanner/plan/end_cuts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/services/fabplanner/sloped_part.h"

namespace mortise::fabplanner {
namespace {

constexpr double kDegree = M_PI / 180;

TEST(EndCutsTest, AnglesAndSlopesAreTheSame) {
  for (const double mitre : {-50.0, 0.0, 22.5, 45.0}) {
    for (const double bevel : {-45.0, 0.0, 33.9, 45.0}) {
      const EndSlope end = SlopeOf(mitre * kDegree, bevel * kDegree);
      EXPECT_NEAR(MitreOf(end), mitre * kDegree, 1e-12);
      EXPECT_NEAR(BevelOf(end), bevel * kDegree, 1e-12);
      // The blade's plane has the normal of a table turned by the mitre, tilted by the bevel.
      const double m = mitre * kDegree, b = bevel * kDegree;
      const Eigen::Vector3d blade(std::cos(m) * std::cos(b), -std::sin(m) * std::cos(b),
                                  -std::sin(b));
      const Eigen::Vector3d normal(1, -end.across, -end.through);
      EXPECT_NEAR(blade.cross(normal).norm(), 0, 1e-12) << mitre << " " << bevel;
      // A kerf is measured along the board, not across the blade.
      EXPECT_NEAR(KerfAlong(end, 0.003), 0.003 / blade.x(), 1e-12);
    }
  }
}

TEST(EndCutsTest, CrownOfFourSidesIsAKnownCompoundCut) {
  // Published: crown moulding of 38° spring angle at a corner of 90° lies flat at a mitre of 31.6°
  // and a bevel of 33.9°. Both follow from the plane in which the corner lies.
  const double spring = 38 * kDegree;
  const EndSlope end = SlopeOf(31.62 * kDegree, 33.86 * kDegree);
  EXPECT_NEAR(end.across, std::sin(spring), 2e-4);
  EXPECT_NEAR(end.through, std::cos(spring), 2e-4);
}

TEST(EndCutsTest, EndsAreFoundHoweverThePartStandsAndIsGiven) {
  const EndSlope slopes[] = {{}, {1, 0}, {-0.4, 0}, {0, 0.6}, {0, -1}, {0.5, -0.7}, {-1.1, -0.3}};
  for (const EndSlope& front : slopes) {
    for (const EndSlope& rear : slopes) {
      for (int length_axis = 0; length_axis < 3; ++length_axis) {
        for (const int next : {1, 2}) {
          const Part part = SlopedLumber("part", "items/apron-20", {0.6, 0.09, 0.02}, {front, rear},
                                         length_axis, (length_axis + next) % 3);
          const auto found = EndsOf(part);
          ASSERT_TRUE(found);
          EXPECT_NEAR(found->front.across, front.across, 1e-9);
          EXPECT_NEAR(found->front.through, front.through, 1e-9);
          EXPECT_NEAR(found->rear.across, rear.across, 1e-9);
          EXPECT_NEAR(found->rear.through, rear.through, 1e-9);
        }
      }
    }
  }
}

TEST(EndCutsTest, PrismsWithSlopedEndsAreCutEveryOtherIsNot) {
  Part rail;
  rail.length_axis = 0;
  rail.thickness_axis = 1;
  rail.extrusion_axis = 1;  // (u, v) are z and x
  rail.from = 0.1;
  rail.to = 0.12;
  rail.outline = {{0, 0}, {0.045, 0.045}, {0.045, 0.355}, {0, 0.4}};
  const auto mitred = EndsOf(rail);
  ASSERT_TRUE(mitred);
  // v = w × u is -z here: the front runs on as z grows, so it falls back as v grows.
  EXPECT_NEAR(mitred->front.across, -1, 1e-9);
  EXPECT_NEAR(mitred->rear.across, 1, 1e-9);
  EXPECT_EQ(mitred->front.through, 0);

  rail.outline = {{0, 0}, {0.045, 0.045}, {0.045, 0.4}};  // a point at the rear
  EXPECT_TRUE(EndsOf(rail));
  rail.outline = {{0, 0}, {0.045, 0.045}, {0.045, 0.355}, {0.02, 0.38}, {0, 0.355}};  // two cuts
  EXPECT_FALSE(EndsOf(rail));
  rail.outline = {{0, 0}, {0.045, 0}, {0.03, 0.4}, {0, 0.4}};  // tapered
  EXPECT_FALSE(EndsOf(rail));
  rail.outline = {{0, 0},       {0.045, 0.045}, {0.045, 0.2},   {0.03, 0.2},
                  {0.03, 0.21}, {0.045, 0.21},  {0.045, 0.355}, {0, 0.4}};  // notched
  EXPECT_FALSE(EndsOf(rail));
}

TEST(EndCutsTest, TurnsAreThoseOfTheSolid) {
  const CutEnds ends = {{0.5, -0.2}, {-0.3, 0.9}};
  const Eigen::Vector3d size(0.7, 0.06, 0.04);
  const struct {
    CutEnds turned;
    Eigen::Vector3d signs;
  } turns[] = {{TurnedAboutLength(ends), {1, -1, -1}},
               {TurnedAboutWidth(ends), {-1, 1, -1}},
               {TurnedAboutThickness(ends), {-1, -1, 1}}};
  for (const auto& [turned, signs] : turns) {
    Part part = SlopedLumber("part", "items/apron-20", size, ends, 0, 2);
    part.vertices = signs.asDiagonal() * part.vertices;
    const auto found = EndsOf(part);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->front.across, turned.front.across, 1e-9);
    EXPECT_NEAR(found->front.through, turned.front.through, 1e-9);
    EXPECT_NEAR(found->rear.across, turned.rear.across, 1e-9);
    EXPECT_NEAR(found->rear.through, turned.rear.through, 1e-9);
  }
}

TEST(EndCutsTest, PeopleReadDegrees) {
  EXPECT_EQ(EndsText({}), "");
  EXPECT_EQ(EndsText({SlopeOf(M_PI / 4, 0), SlopeOf(-M_PI / 4, 0)}), "both ends 45°");
  EXPECT_EQ(EndsText({SlopeOf(22.5 * kDegree, 0), {}}), "ends 22.5° and square");
  EXPECT_EQ(EndText(SlopeOf(0, -30 * kDegree)), "bevel 30°");
  EXPECT_EQ(EndText(SlopeOf(31.62 * kDegree, 33.86 * kDegree)), "31.6°, bevel 33.9°");
}

}  // namespace
}  // namespace mortise::fabplanner
