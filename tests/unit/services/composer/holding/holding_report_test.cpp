// Whole designs: will they stand and hold?
#include "services/composer/holding/holding_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/holding/holding_parts.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::FixedPart;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

// A seat of 0.4 x 0.4 m on a foot in its middle.
HoldingReport Stool(double foot) {
  const double r = foot / 2;
  const auto design =
      AsDrawn(parametric::Named("stool", {FixedPart("foot", {-r, -r, 0}, {r, r, 0.4}),
                                          FixedPart("seat", {-0.2, -0.2, 0.4}, {0.2, 0.2, 0.45})}));
  EXPECT_TRUE(design.ok()) << design.status();
  const auto report = CheckHolding(*design, TestItems(), TestMaterials());
  EXPECT_TRUE(report.ok()) << report.status();
  return *report;
}

// A load 60 mm from the seat's edge is 40 mm beyond a foot of 0.2 m, whose edge is 100 mm from the
// weight.
TEST(HoldingReportTest, ALoadAtTheEdgeOfASeatTipsIt) {
  const HoldingReport report = Stool(0.2);
  const double weight = 9.81 * kWood * (0.2 * 0.2 * 0.4 + 0.4 * 0.4 * 0.05);
  ASSERT_THAT(report.surfaces, SizeIs(1));
  const SurfaceCheck& seat = report.surfaces[0];
  EXPECT_EQ(seat.surface.kind, BearingKind::kSeat);
  EXPECT_NEAR(seat.tipping_force, weight * 0.1 / 0.04, 1e-6);
  EXPECT_EQ(seat.tipping_wanted, 600);
  EXPECT_NEAR(seat.tipping_at.cwiseAbs().maxCoeff(), 0.14, 1e-12);
  ASSERT_LT(seat.tipping_force, 600);
  const auto is_tipping = [](const Finding& each) { return each.rule == "tips-under-load"; };
  const auto found = std::find_if(report.findings.begin(), report.findings.end(), is_tipping);
  ASSERT_NE(found, report.findings.end());
  EXPECT_THAT(found->parts, ElementsAre("seat"));
  EXPECT_THAT(found->source, HasSubstr("EN 1022"));
}

TEST(HoldingReportTest, OnAWiderFootNothingTipsIt) {
  const HoldingReport report = Stool(0.3);
  EXPECT_TRUE(std::isinf(report.surfaces.at(0).tipping_force));
  EXPECT_THAT(report.findings, Not(Contains(Field(&Finding::rule, "tips-under-load"))));
  // Nothing but its weight holds the seat on the foot.
  ASSERT_THAT(report.findings, SizeIs(1));
  EXPECT_EQ(report.findings[0].rule, "only-touches");
  EXPECT_THAT(report.not_judged, Contains(HasSubstr("glue")));
}

TEST(HoldingReportTest, WhatLeansTooFarTopples) {
  ASSERT_OK_AND_ASSIGN(
      const Design lamp,
      AsDrawn(parametric::Named("lamp", {FixedPart("foot", {0, 0, 0}, {0.1, 0.1, 0.1}),
                                         FixedPart("arm", {0, 0, 0.1}, {0.6, 0.1, 0.2})})));
  ASSERT_OK_AND_ASSIGN(const HoldingReport report,
                       CheckHolding(lamp, TestItems(), TestMaterials()));
  const double center = (0.05 * 1 + 0.3 * 6) / 7;
  ASSERT_THAT(report.findings, Not(IsEmpty()));
  EXPECT_EQ(report.findings[0].rule, "topples");
  EXPECT_EQ(report.findings[0].severity, Severity::kFault);
  EXPECT_NEAR(report.findings[0].found, 0.1 - center, 1e-9);
  EXPECT_THAT(report.findings[0].text, HasSubstr("to the right (+x)"));
}

// Experts drew them: nothing of them falls over, comes apart, or has screws that come out.
TEST(HoldingReportTest, DesignsThatShipHaveNoFaults) {
  for (const char* id : {"dining_table", "bookshelf", "cabinet", "garden_bench", "step_stool"}) {
    SCOPED_TRACE(id);
    ASSERT_OK_AND_ASSIGN(
        const HoldingReport report,
        CheckHolding(ShippedDesign(id), parametric::ShippedItems(), ShippedMaterials()));
    EXPECT_GT(report.standing.poses.at(report.worst_pose).standing.margin, 0);
    EXPECT_THAT(report.surfaces, Not(IsEmpty()));
    for (const Finding& finding : report.findings) {
      EXPECT_NE(finding.severity, Severity::kFault) << finding.rule << ": " << finding.text;
    }
  }
}

}  // namespace
}  // namespace mortise::composer
