#include "services/fabplanner/planning/part_making.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/errors.h"
#include "services/fabplanner/documents/part_drawing.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "tests/unit/services/fabplanner/example_table.h"
#include "tests/unit/services/fabplanner/sloped_part.h"

namespace mortise::fabplanner {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The prism as triangles.
Part Faceted(Part part) {
  const render::Shape shape = PartShape(part, Eigen::Vector3d::Zero());
  part.vertices = shape.vertices;
  part.triangles = shape.triangles;
  part.outline.clear();
  return part;
}

Part Leg() {
  return BoxPart("leg", "items/leg-45", CutProcess::kChopSaw, {0, 0, 0}, {0.045, 0.045, 0.7}, 2, 0);
}

// A leg that tapers: its outline in (z, x) is extruded along y.
Part TaperedLeg() {
  Part leg = Leg();
  leg.extrusion_axis = 1;
  leg.outline = {{0, 0}, {0.7, 0}, {0.7, 0.045}, {0, 0.02}};
  leg.from = 0;
  leg.to = 0.045;
  return leg;
}

PlannedPart PlanOf(const Part& part, const Items& items = ExampleItems()) {
  Design design;
  design.parts = {part};
  const auto planned = PlanParts(design, items);
  EXPECT_TRUE(planned.ok()) << planned.status();
  return planned.ok() ? planned->front() : PlannedPart{};
}

TEST(PartMakingTest, WhatACrosscutGivesTakesNoDrawing) {
  EXPECT_EQ(PlanOf(Leg()).making, Making::kCrosscut);
  EXPECT_FALSE(PlanOf(Leg()).to_shape);
  EXPECT_FALSE(PlanOf(Faceted(Leg())).to_shape);  // a box, however it is given
}

TEST(PartMakingTest, WhatACrosscutDoesNotGiveIsShapedFromItsBlank) {
  for (const Part& part : {TaperedLeg(), Faceted(TaperedLeg())}) {
    const PlannedPart planned = PlanOf(part);
    EXPECT_EQ(planned.making, Making::kCrosscut);
    EXPECT_TRUE(planned.to_shape);
    EXPECT_THAT(planned.handwork, HasSubstr("700 × 45 × 45 mm"));
  }
  Items items = ExampleItems();
  items["items/leg-45"].shaped = true;  // a profile looks like that anyway
  EXPECT_FALSE(PlanOf(Faceted(TaperedLeg()), items).to_shape);
}

constexpr double kDegree = M_PI / 180;

PlannedPart PlanBy(const WorkshopRules& rules, const Part& part) {
  Design design;
  design.parts = {part};
  const auto planned = PlanParts(design, ExampleItems(), rules);
  EXPECT_TRUE(planned.ok()) << planned.status();
  return planned.ok() ? planned->front() : PlannedPart{};
}

// A rail of 20 × 90 mm that lies along x, its thickness along y.
Part Rail(const EndSlope& front, const EndSlope& rear) {
  return SlopedLumber("rail", "items/apron-20", {0.6, 0.09, 0.02}, {front, rear}, 0, 1);
}

TEST(PartMakingTest, MitresAndBevelsAreSawnUpToTheRules) {
  const EndSlope mitre = SlopeOf(50 * kDegree, 0), bevel = SlopeOf(0, -45 * kDegree),
                 compound = SlopeOf(-31.6 * kDegree, 33.9 * kDegree);
  for (const EndSlope& end : {mitre, bevel, compound}) {
    const PlannedPart planned = PlanOf(Rail(end, {}));
    EXPECT_EQ(planned.making, Making::kCrosscut);
    EXPECT_FALSE(planned.to_shape);
    EXPECT_EQ(planned.handwork, "");
    EXPECT_NEAR(planned.ends.front.across, end.across, 1e-9);
    EXPECT_NEAR(planned.ends.front.through, end.through, 1e-9);
    EXPECT_TRUE(IsSquare(planned.ends.rear));
    EXPECT_TRUE(planned.size.isApprox(Eigen::Vector3d(0.6, 0.09, 0.02)));
  }
  // Prisms are taken as triangles are.
  Part prism = Leg();
  prism.extrusion_axis = 1;
  prism.outline = {{0, 0}, {0.7, 0}, {0.655, 0.045}, {0.045, 0.045}};
  prism.to = 0.045;
  EXPECT_FALSE(PlanOf(prism).to_shape);
  EXPECT_NEAR(std::abs(PlanOf(prism).ends.front.across), 1, 1e-9);
}

TEST(PartMakingTest, WhatTheSawCannotDoIsNamedWithPartEndAndAngle) {
  const PlannedPart steep = PlanOf(Rail(SlopeOf(30 * kDegree, 0), SlopeOf(-60 * kDegree, 0)));
  EXPECT_TRUE(steep.to_shape);
  EXPECT_NEAR(MitreOf(steep.ends.front), 30 * kDegree, 1e-9);  // that end is sawn all the same
  EXPECT_TRUE(IsSquare(steep.ends.rear));
  ASSERT_EQ(steep.beyond_machines.size(), 1);
  const MachineLimit& limit = steep.beyond_machines.front();
  EXPECT_EQ(limit.kind, MachineLimit::Kind::kMitre);
  EXPECT_EQ(limit.place, "end towards +x");
  EXPECT_NEAR(limit.value, 60 * kDegree, 1e-9);
  EXPECT_EQ(limit.limit, WorkshopRules{}.mitre_limit);
  EXPECT_THAT(steep.handwork,
              HasSubstr("its end towards +x is a mitre of 60°, but the chop saw's table turns by "
                        "50° at most: saw what is left by hand"));

  const PlannedPart tilted = PlanOf(Rail(SlopeOf(0, 46 * kDegree), SlopeOf(0, 46 * kDegree)));
  ASSERT_EQ(tilted.beyond_machines.size(), 2);
  EXPECT_EQ(tilted.beyond_machines[0].kind, MachineLimit::Kind::kBevel);
  EXPECT_EQ(tilted.beyond_machines[0].place, "end towards -x");
  EXPECT_EQ(tilted.beyond_machines[1].place, "end towards +x");

  const Part crown = Rail(SlopeOf(31.6 * kDegree, 33.9 * kDegree), {});
  EXPECT_TRUE(PlanOf(crown).beyond_machines.empty());
  const PlannedPart no_compound = PlanBy({.compound_cuts = false}, crown);
  ASSERT_EQ(no_compound.beyond_machines.size(), 1);
  EXPECT_EQ(no_compound.beyond_machines[0].kind, MachineLimit::Kind::kCompound);
  // A saw that only cuts square makes the blank.
  EXPECT_TRUE(AreSquare(PlanBy({.mitre_limit = 0, .bevel_limit = 0}, crown).ends));
  // Larger machines do more.
  EXPECT_TRUE(PlanBy({.mitre_limit = 60 * kDegree}, Rail(SlopeOf(60 * kDegree, 0), {}))
                  .beyond_machines.empty());
}

TEST(PartMakingTest, SquareStockIsTurnedSoThatItsBevelsAreMitres) {
  const Eigen::Vector3d size(0.7, 0.045, 0.045);
  const EndSlope bevel = SlopeOf(0, 48 * kDegree);  // too much for the blade, not for the table
  const PlannedPart planned =
      PlanOf(SlopedLumber("leg", "items/leg-45", size, {bevel, bevel}, 2, 0));
  EXPECT_TRUE(planned.beyond_machines.empty());
  EXPECT_NEAR(MitreOf(planned.ends.front), 48 * kDegree, 1e-9);
  EXPECT_EQ(planned.ends.front.through, 0);
  EXPECT_EQ(planned.ends.front, planned.ends.rear);
}

// A plate with a notch in its upper edge: its corners are rounded by `radius` in `steps` each.
Part Notched(double radius, int steps) {
  Part panel =
      BoxPart("panel", "items/plywood-18", CutProcess::kJigsaw, {0, 0, 0}, {0.5, 0.4, 0.018}, 0, 2);
  panel.outline = {{0, 0}, {0.5, 0}, {0.5, 0.4}, {0.3, 0.4}};
  const auto round = [&](const Eigen::Vector2d& centre, double from) {
    for (int i = 0; i <= steps; ++i) {
      const double angle = from - M_PI / 2 * i / std::max(steps, 1);
      panel.outline.emplace_back(centre +
                                 radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      if (radius == 0) break;
    }
  };
  round({0.3 - radius, 0.3 + radius}, 0);
  round({0.2 + radius, 0.3 + radius}, -M_PI / 2);
  panel.outline.emplace_back(0.2, 0.4);
  panel.outline.emplace_back(0, 0.4);
  return panel;
}

TEST(PartMakingTest, InnerArcsAndCornersKeepTheJigsawsRadius) {
  for (const int steps : {3, 4, 8, 30}) {
    SCOPED_TRACE(steps);
    EXPECT_TRUE(PlanOf(Notched(0.03, steps)).beyond_machines.empty());
    EXPECT_TRUE(PlanOf(Notched(0.01, steps)).beyond_machines.empty());  // as tight as it goes
    const PlannedPart tight = PlanOf(Notched(0.006, steps));
    ASSERT_EQ(tight.beyond_machines.size(), 1);
    EXPECT_EQ(tight.beyond_machines[0].kind, MachineLimit::Kind::kRadius);
    EXPECT_NEAR(tight.beyond_machines[0].value, 0.006, 0.0003);
    EXPECT_THAT(tight.beyond_machines[0].place, HasSubstr("inner arcs at "));
    EXPECT_FALSE(tight.to_shape);  // the outline shows it
    EXPECT_TRUE(PlanBy({.jigsaw_radius = 0.006}, Notched(0.006, steps)).beyond_machines.empty());
    EXPECT_TRUE(PlanOf(Faceted(Notched(0.03, steps))).beyond_machines.empty());
  }
  const PlannedPart sharp = PlanOf(Notched(0, 1));
  ASSERT_EQ(sharp.beyond_machines.size(), 1);
  EXPECT_EQ(sharp.beyond_machines[0].value, 0);
  EXPECT_EQ(sharp.beyond_machines[0].place, "inner corners at 300, 300 mm; 200, 300 mm");
  EXPECT_THAT(sharp.handwork, HasSubstr("leaves a radius of 10 mm: cut out what is left by hand"));
  // A saw that turns on the spot makes them.
  EXPECT_TRUE(PlanBy({.jigsaw_radius = 0}, Notched(0, 1)).beyond_machines.empty());
}

TEST(PartMakingTest, SlotsAndFlatBendsAreTold) {
  Part panel =
      BoxPart("panel", "items/plywood-18", CutProcess::kJigsaw, {0, 0, 0}, {0.5, 0.4, 0.018}, 0, 2);
  // A slot of 18 mm, in which a saw of 10 mm radius does not turn.
  panel.outline = {{0, 0},       {0.5, 0},     {0.5, 0.4},   {0.259, 0.4},
                   {0.259, 0.2}, {0.241, 0.2}, {0.241, 0.4}, {0, 0.4}};
  ASSERT_EQ(PlanOf(panel).beyond_machines.size(), 1);
  EXPECT_THAT(PlanOf(panel).beyond_machines[0].place, HasSubstr("inner corners"));
  // A bend by 15 degrees leaves a tenth of a millimetre.
  panel.outline = {{0, 0}, {0.5, 0}, {0.5, 0.467}, {0.25, 0.4}, {0, 0.467}};
  EXPECT_TRUE(PlanOf(panel).beyond_machines.empty());
}

TEST(PartMakingTest, UprightOutlinesAreCutWhatHasHolesTakesADrawing) {
  Part panel = BoxPart("panel", "items/plywood-18", CutProcess::kJigsaw, {0, 0, 0.1},
                       {0.5, 0.4, 0.118}, 0, 2);
  panel.outline = {{0, 0}, {0.5, 0}, {0.4, 0.4}, {0.1, 0.4}, {0, 0.2}};
  EXPECT_FALSE(PlanOf(panel).to_shape);
  EXPECT_FALSE(PlanOf(Faceted(panel)).to_shape);
  const std::vector<Eigen::Vector2d> outline = SheetOutlineOf(Faceted(panel));
  ASSERT_EQ(outline.size(), 5);
  double area = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    area +=
        (outline[i].x() * outline[(i + 1) % 5].y() - outline[(i + 1) % 5].x() * outline[i].y()) / 2;
  }
  EXPECT_NEAR(area, 0.5 * 0.4 - 0.1 * 0.4 / 2 - 0.1 * 0.2 / 2, 1e-9);

  panel.extrusion_axis = 0;  // a chamfer along the panel
  panel.outline = {{0, 0.1}, {0.4, 0.1}, {0.4, 0.118}, {0.01, 0.118}};
  panel.from = 0;
  panel.to = 0.5;
  EXPECT_TRUE(PlanOf(panel).to_shape);
  EXPECT_TRUE(PlanOf(Faceted(panel)).to_shape);
  EXPECT_EQ(SheetOutlineOf(panel).size(), 4);
}

// A plate of 500 × 400 × 18 mm, whose edges are mitred at 45° so that one side is smaller.
Part MitredPlate(bool smaller_side_up) {
  Part plate = Faceted(BoxPart("plate", "items/plywood-18", CutProcess::kJigsaw, {0, 0, 0},
                               {0.5, 0.4, 0.018}, 0, 2));
  for (Eigen::Index i = 0; i < plate.vertices.cols(); ++i) {
    auto vertex = plate.vertices.col(i);
    if ((vertex.z() > 0.009) != smaller_side_up) continue;
    vertex.x() += vertex.x() > 0.25 ? -0.018 : 0.018;
    vertex.y() += vertex.y() > 0.2 ? -0.018 : 0.018;
  }
  return plate;
}

TEST(PartMakingTest, MitredEdgesAreShapedFromTheLargerSide) {
  for (bool smaller_side_up : {true, false}) {
    const Part plate = MitredPlate(smaller_side_up);
    EXPECT_TRUE(PlanOf(plate).to_shape);
    EXPECT_THAT(PlanOf(plate).handwork, HasSubstr("500 × 400 × 18 mm"));
    EXPECT_THAT(SheetOutlineOf(plate),
                ElementsAre(Eigen::Vector2d(0, 0), Eigen::Vector2d(0.5, 0),
                            Eigen::Vector2d(0.5, 0.4), Eigen::Vector2d(0, 0.4)));
  }
}

// A round bar of 30 mm along an axis, 600 mm long, as triangles; with a neck in the middle if
// `neck` is less than 30 mm.
Part RoundBar(int axis, double neck = 0.03) {
  constexpr int kSides = 24;
  const std::vector<std::pair<double, double>> rings = {
      {0, 0.03}, {0.2, 0.03}, {0.3, neck}, {0.4, 0.03}, {0.6, 0.03}};
  const int count = static_cast<int>(rings.size());
  Part bar =
      Faceted(BoxPart("bar", "items/bar-30", CutProcess::kChopSaw, {0, 0, 0},
                      {axis == 0 ? 0.6 : 0.03, axis == 1 ? 0.6 : 0.03, axis == 2 ? 0.6 : 0.03},
                      axis, (axis + 2) % 3));
  bar.vertices.setZero(3, kSides * count + 2);
  bar.triangles.resize(3, 2 * kSides * count);
  Eigen::Index t = 0;
  for (int ring = 0; ring < count; ++ring) {
    for (int i = 0; i < kSides; ++i) {
      const int next = (i + 1) % kSides;
      auto vertex = bar.vertices.col(ring * kSides + i);
      vertex[axis] = rings[ring].first;
      vertex[(axis + 1) % 3] = 0.015 + rings[ring].second / 2 * std::cos(2 * M_PI * i / kSides);
      vertex[(axis + 2) % 3] = 0.015 + rings[ring].second / 2 * std::sin(2 * M_PI * i / kSides);
      if (ring + 1 == count) continue;
      const int a = ring * kSides + i, b = ring * kSides + next;
      bar.triangles.col(t++) = Eigen::Vector3i(a, b, b + kSides);
      bar.triangles.col(t++) = Eigen::Vector3i(a, b + kSides, a + kSides);
    }
  }
  const int start = kSides * count, last = kSides * (count - 1);
  for (int end : {start, start + 1}) {
    bar.vertices.col(end).setConstant(0.015);
    bar.vertices(axis, end) = end == start ? 0 : 0.6;
  }
  for (int i = 0; i < kSides; ++i) {
    const int next = (i + 1) % kSides;
    bar.triangles.col(t++) = Eigen::Vector3i(start, next, i);
    bar.triangles.col(t++) = Eigen::Vector3i(start + 1, last + i, last + next);
  }
  return bar;
}

TEST(PartMakingTest, RoundStockIsCrosscutAndTurnedPartsAreShapedWhicheverWayTheyStand) {
  Items items = ExampleItems();
  items["items/bar-30"] = {
      .name = "items/bar-30", .title = "Bar", .kind = ItemKind::kDowel, .round = true};
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(VolumeOf(RoundBar(axis)) / (M_PI / 4 * 0.03 * 0.03 * 0.6), 0.9886, 1e-4);
    EXPECT_FALSE(PlanOf(RoundBar(axis), items).to_shape) << axis;
    EXPECT_TRUE(PlanOf(RoundBar(axis, 0.029), items).to_shape) << axis;
    EXPECT_TRUE(PlanOf(RoundBar(axis, 0.015), items).to_shape) << axis;
  }
  // Flattened all along: one section, but not the stock's.
  Part flat = RoundBar(2);
  for (Eigen::Index i = 0; i < flat.vertices.cols(); ++i) {
    flat.vertices(0, i) = std::max(flat.vertices(0, i), 0.008);
  }
  EXPECT_TRUE(PlanOf(flat, items).to_shape);
  items["items/bar-30"].kind = ItemKind::kBoard;  // a tube
  EXPECT_FALSE(PlanOf(RoundBar(2), items).to_shape);
  EXPECT_TRUE(PlanOf(RoundBar(2, 0.015), items).to_shape);
}

TEST(PartMakingTest, WhatIsOfNoItemIsMadeToDrawing) {
  Part part = Faceted(TaperedLeg());
  part.item.clear();
  const PlannedPart planned = PlanOf(part);
  EXPECT_EQ(planned.making, Making::kToDrawing);
  EXPECT_TRUE(planned.size.isApprox(Eigen::Vector3d(0.045, 0.045, 0.7)));
}

TEST(PartMakingTest, NamesThePartItemAndSizesThatDoNotMatch) {
  Items items = ExampleItems();
  items["items/leg-45"].limits = {{{0.04, 2.4}, {0.06, 0.06}, {0.02, 0.08}}};
  Design design;
  design.parts = {Leg()};
  const absl::Status status = PlanParts(design, items).status();
  EXPECT_EQ(DetailOf(status).reason, "PART_NOT_IN_STOCK");
  EXPECT_THAT(std::string(status.message()),
              AllOf(HasSubstr("part leg is 45 mm wide"), HasSubstr("items/leg-45 is 60 mm")));
  items["items/leg-45"].limits[1] = {0.02, 0.08};
  EXPECT_TRUE(PlanParts(design, items).ok());
  items["items/leg-45"].limits[0] = {0.8, 2.4};  // the saw's feeder holds nothing shorter
  EXPECT_THAT(std::string(PlanParts(design, items).status().message()),
              HasSubstr("700 mm long, but items/leg-45 can be 800 to 2400 mm long"));
}

TEST(PartMakingTest, RefusesPartsWithoutUsableNumbers) {
  Design design;
  EXPECT_EQ(PlanParts(design, ExampleItems()).status().code(), absl::StatusCode::kInvalidArgument);
  Part part = Faceted(Leg());
  part.triangles(0, 0) = 99;
  design.parts = {part};
  EXPECT_EQ(PlanParts(design, ExampleItems()).status().code(), absl::StatusCode::kInvalidArgument);
  part = Leg();
  part.size.x() = 0;
  design.parts = {part};
  EXPECT_EQ(PlanParts(design, ExampleItems()).status().code(), absl::StatusCode::kInvalidArgument);
  part = Leg();
  part.item = "items/none";
  design.parts = {part};
  EXPECT_THAT(std::string(PlanParts(design, ExampleItems()).status().message()),
              HasSubstr("items/none"));
}

TEST(PartDrawingTest, AlikePartsShareADrawing) {
  Design design;
  for (int i = 0; i < 3; ++i) {
    Part leg = Faceted(TaperedLeg());
    leg.name = i < 2 ? "Leg " + std::to_string(i) : "leg 0!";
    if (i < 2) leg.family = "Leg";
    leg.vertices.row(0).array() += 0.5 * i;
    design.parts.push_back(leg);
  }
  FabricationPlan plan;
  plan.parts = *PlanParts(design, ExampleItems());
  NameDrawings(design, &plan);
  EXPECT_THAT(plan.parts[0].drawings, ElementsAre("part-leg-0.svg", "part-leg-0.stl"));
  EXPECT_EQ(plan.parts[1].drawings, plan.parts[0].drawings);
  EXPECT_THAT(plan.parts[2].drawings, ElementsAre("part-leg-0-2.svg", "part-leg-0-2.stl"));

  const std::string svg = PartDrawingSvg(design.parts[0], "note <1>");
  EXPECT_THAT(svg, AllOf(HasSubstr("note &lt;1&gt;"), HasSubstr("from above"), HasSubstr(">700<"),
                         HasSubstr(">45<")));
}

}  // namespace
}  // namespace mortise::fabplanner
