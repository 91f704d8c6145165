#include "services/fabplanner/joining/fastener_holes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

constexpr double kTiny = 1e-9;

// Two boards of 18 mm, one on the other: lower from z = 0, upper from z = 0.018.
Design TwoBoards() {
  Design design;
  for (int i = 0; i < 2; ++i) {
    design.parts.push_back(BoxPart(i == 0 ? "lower" : "upper", "items/plywood-18",
                                   CutProcess::kJigsaw, {0, 0, 0.018 * i},
                                   {0.3, 0.2, 0.018 * (i + 1)}, 0, 2));
  }
  return design;
}

Items WithBolt() {
  Items items = ExampleItems();
  const auto add = [&items](const char* name, ItemKind kind) -> Item& {
    Item& item = items[name];
    item.name = name;
    item.kind = kind;
    return item;
  };
  add("items/bolt", ItemKind::kBolt).measures = {{"thread_pitch", 0.00125}};
  add("items/pin", ItemKind::kHardware).pin = true;
  add("items/slide", ItemKind::kHardware);
  return items;
}

FabricationPlan HolesOf(const Design& design, const Items& items = WithBolt()) {
  FabricationPlan plan;
  AddFastenerHoles(design, items, &plan);
  return plan;
}

void ExpectHole(const Hole& hole, const std::string& part, HoleKind kind, double diameter,
                double depth, bool through, double z, double direction) {
  EXPECT_EQ(hole.part, part);
  EXPECT_EQ(hole.kind, kind);
  EXPECT_NEAR(hole.diameter, diameter, kTiny);
  EXPECT_NEAR(hole.depth, depth, kTiny);
  EXPECT_EQ(hole.through, through);
  EXPECT_TRUE(hole.position.isApprox(Eigen::Vector3d(0.1, 0.1, z), 1e-9)) << hole.position.z();
  EXPECT_EQ(hole.direction, Eigen::Vector3d(0, 0, direction));
}

TEST(FastenerHolesTest, AScrewPassesTheFirstPartAndBitesInTheLast) {
  Design design = TwoBoards();
  design.parts.push_back(ScrewPart("screw", {0.1, 0.1, 0.036}, 2, -1, 0.03));
  std::vector<Hole> holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 2);
  ExpectHole(holes[0], "upper", HoleKind::kClearance, 0.0045, 0.018, true, 0.036, -1);
  ExpectHole(holes[1], "lower", HoleKind::kPilot, 0.003, 0.012, false, 0.018, -1);
  EXPECT_EQ(holes[1].connector, "screw");

  // The other way round it is the same from below.
  design.parts[2] = ScrewPart("screw", {0.1, 0.1, 0}, 2, 1, 0.03);
  holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 2);
  ExpectHole(holes[0], "lower", HoleKind::kClearance, 0.0045, 0.018, true, 0, 1);
  ExpectHole(holes[1], "upper", HoleKind::kPilot, 0.003, 0.012, false, 0.018, 1);
}

TEST(FastenerHolesTest, AHeadBelowTheSurfaceIsCounterbored) {
  Design design = TwoBoards();
  design.parts.push_back(ScrewPart("screw", {0.1, 0.1, 0.031}, 2, -1, 0.025));
  const std::vector<Hole> holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 3);
  ExpectHole(holes[0], "upper", HoleKind::kClearance, 0.008, 0.005, false, 0.036, -1);
  ExpectHole(holes[1], "upper", HoleKind::kClearance, 0.0045, 0.018, true, 0.036, -1);
  ExpectHole(holes[2], "lower", HoleKind::kPilot, 0.003, 0.012, false, 0.018, -1);
}

TEST(FastenerHolesTest, AScrewFlushAtBothEndsHasItsHeadInTheThinnerPart) {
  for (const double lower : {0.012, 0.024}) {
    Design design;
    for (int i = 0; i < 2; ++i) {
      design.parts.push_back(BoxPart(i == 0 ? "lower" : "upper", "items/plywood-18",
                                     CutProcess::kJigsaw, {0, 0, i == 0 ? 0 : lower},
                                     {0.3, 0.2, i == 0 ? lower : 0.036}, 0, 2));
    }
    for (const int direction : {-1, 1}) {
      design.parts.resize(2);
      design.parts.push_back(
          ScrewPart("screw", {0.1, 0.1, direction > 0 ? 0 : 0.036}, 2, direction, 0.036));
      const std::vector<Hole> holes = HolesOf(design).holes;
      ASSERT_EQ(holes.size(), 2);
      const bool from_below = lower < 0.018;
      EXPECT_EQ(holes[0].kind, HoleKind::kClearance);
      EXPECT_EQ(holes[0].part, from_below ? "lower" : "upper");
      EXPECT_EQ(holes[0].direction.z(), from_below ? 1 : -1);
      EXPECT_EQ(holes[1].kind, HoleKind::kPilot);
      EXPECT_EQ(holes[1].part, from_below ? "upper" : "lower");
    }
  }
}

TEST(FastenerHolesTest, OnlyPinsAmongHardwareAreDrilledFor) {
  Items items = WithBolt();
  Design design = TwoBoards();
  design.parts.push_back(ScrewPart("link", {0.1, 0.1, 0.03}, 2, -1, 0.024, 0.005, "items/slide"));
  EXPECT_TRUE(HolesOf(design, items).holes.empty());
  items["items/slide"].pin = true;
  EXPECT_EQ(HolesOf(design, items).holes.size(), 2);
}

TEST(FastenerHolesTest, WhatTheItemSaysGoesBeforeTheRule) {
  Items items = WithBolt();
  items["items/screw-4x40"].measures = {{"pilot_diameter", 0.0025}, {"clearance_diameter", 0.004}};
  Design design = TwoBoards();
  design.parts.push_back(ScrewPart("screw", {0.1, 0.1, 0.036}, 2, -1, 0.03));
  const std::vector<Hole> holes = HolesOf(design, items).holes;
  ASSERT_EQ(holes.size(), 2);
  EXPECT_EQ(holes[0].diameter, 0.004);
  EXPECT_EQ(holes[1].diameter, 0.0025);
}

TEST(FastenerHolesTest, ABoltHasRoomOrAThread) {
  EXPECT_DOUBLE_EQ(ClearanceOf(0.003), 0.0034);  // ISO 273, medium
  EXPECT_DOUBLE_EQ(ClearanceOf(0.008), 0.009);
  EXPECT_DOUBLE_EQ(ClearanceOf(0.02), 0.022);
  Design design = TwoBoards();
  design.parts.push_back(ScrewPart("bolt", {0.1, 0.1, 0.043}, 2, -1, 0.05, 0.008, "items/bolt"));
  std::vector<Hole> holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 2);  // through both
  for (const Hole& hole : holes) {
    EXPECT_EQ(hole.kind, HoleKind::kClearance);
    EXPECT_DOUBLE_EQ(hole.diameter, 0.009);
    EXPECT_TRUE(hole.through);
  }
  design.parts[2] = ScrewPart("bolt", {0.1, 0.1, 0.036}, 2, -1, 0.03, 0.008, "items/bolt");
  holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 2);
  ExpectHole(holes[1], "lower", HoleKind::kTapped, 0.00675, 0.013, false, 0.018, -1);
}

TEST(FastenerHolesTest, PinsAndPegsFillTheirHoles) {
  Design design = TwoBoards();
  design.parts.push_back(
      ScrewPart("peg", {0.1, 0.1, 0.006}, 2, 1, 0.02, 0.008, "items/dowel-8x35"));
  std::vector<Hole> holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 2);
  ExpectHole(holes[0], "lower", HoleKind::kPeg, 0.008, 0.013, false, 0.018, -1);
  ExpectHole(holes[1], "upper", HoleKind::kPeg, 0.008, 0.009, false, 0.018, 1);

  // A pin that stands out of one board; no deeper than leaves half a millimetre.
  design.parts[2] = ScrewPart("pin", {0.1, 0.1, 0.0187}, 2, 1, 0.03, 0.005, "items/pin");
  holes = HolesOf(design).holes;
  ASSERT_EQ(holes.size(), 1);
  ExpectHole(holes[0], "upper", HoleKind::kPeg, 0.005, 0.0175, false, 0.036, -1);
}

// A rail of 30 mm along x, at z = 0, and a spindle below it that reaches up to `top`. A pin
// elsewhere makes the design one with connectors.
Design RailAndSpindle(double top, double spindle_diameter) {
  const double half = spindle_diameter / 2;
  Design design;
  design.parts.push_back(BoxPart("rail", "items/rod-30", CutProcess::kChopSaw,
                                 {-0.4, -0.015, -0.015}, {0.4, 0.015, 0.015}, 0, 2));
  design.parts.push_back(BoxPart("spindle", "items/rod-20", CutProcess::kChopSaw,
                                 {-half, -half, -0.6}, {half, half, top}, 2, 1));
  design.parts.push_back(ScrewPart("pin", {2, 2, 2}, 2, 1, 0.03, 0.005, "items/pin"));
  return design;
}

TEST(FastenerHolesTest, OfRodsOnlyTheThickerIsDrilled) {
  Items items = WithBolt();
  for (const char* name : {"items/rod-20", "items/rod-30"}) {
    items[name] = {.name = name, .title = "Rod", .kind = ItemKind::kDowel, .round = true};
  }
  // Let in past the rail's axis: the rail's own line crosses the spindle.
  std::vector<Hole> holes = HolesOf(RailAndSpindle(0.001, 0.02), items).holes;
  ASSERT_EQ(holes.size(), 1);
  EXPECT_EQ(holes[0].part, "rail");
  EXPECT_EQ(holes[0].connector, "spindle");
  EXPECT_NEAR(holes[0].diameter, 0.02, kTiny);
  EXPECT_NEAR(holes[0].depth, 0.017, kTiny);
  EXPECT_FALSE(holes[0].through);

  // Tenons at the rail's ends, thinner than the spindle, do not cross it in its middle either.
  items["items/rod-30"].measures = {{"tenon_diameter", 0.012}};
  EXPECT_EQ(HolesOf(RailAndSpindle(0.001, 0.02), items).holes.size(), 1);

  // Right through, and as thick as each other.
  items["items/rod-30"].measures.clear();
  holes = HolesOf(RailAndSpindle(0.2, 0.02), items).holes;
  ASSERT_EQ(holes.size(), 1);
  EXPECT_EQ(holes[0].part, "rail");
  EXPECT_TRUE(holes[0].through);
  EXPECT_TRUE(HolesOf(RailAndSpindle(0.001, 0.03), items).holes.empty());
}

TEST(FastenerHolesTest, WhatNoScrewHoldsIsMarked) {
  Design design = TwoBoards();
  Part slide = BoxPart("slide", "items/slide", CutProcess::kNone, {0.05, 0.02, 0.036},
                       {0.25, 0.06, 0.048}, 0, 2);
  slide.connecting = true;
  design.parts.push_back(slide);
  std::vector<Mark> marks = HolesOf(design).marks;
  ASSERT_EQ(marks.size(), 1);
  EXPECT_EQ(marks[0].part, "upper");
  EXPECT_EQ(marks[0].connector, "slide");
  EXPECT_TRUE(marks[0].region.min().isApprox(Eigen::Vector3d(0.05, 0.02, 0.036)));
  EXPECT_TRUE(marks[0].region.max().isApprox(Eigen::Vector3d(0.25, 0.06, 0.036)));
  design.parts.push_back(ScrewPart("screw", {0.1, 0.04, 0.048}, 2, -1, 0.02));
  EXPECT_TRUE(HolesOf(design).marks.empty());
}

}  // namespace
}  // namespace mortise::fabplanner
