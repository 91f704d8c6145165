// Every kind of feature against volumes that can be worked out by hand.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/cad/solid_surface.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::cad {
namespace {

using std::numbers::pi;

constexpr double kRelative = 1e-7;

void ExpectVolume(const std::string& features, double volume) {
  const auto model = SolidOf("", features);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_NEAR(model->solid.Volume(), volume, kRelative * volume);
}

TEST(FeatureVolume, ExtrudedPlateWithHole) {
  ExpectVolume(
      "features { name: 's' sketch { "
      "profiles { name: 'outline' rectangle { width: '0.1' height: '0.06' round: '0.01' } } "
      "profiles { name: 'bore' hole_of: 'outline' circle { center { x: '0.02' } radius: '0.008' } "
      "} } } features { name: 'plate' extrude { sketch: 's' from: '-0.002' to: '0.003' } }",
      (0.1 * 0.06 - (4 - pi) * 0.01 * 0.01 - pi * 0.008 * 0.008) * 0.005);
}

TEST(FeatureVolume, ClockwisePathsAndArcs) {
  // A half disc, drawn clockwise.
  ExpectVolume(
      "features { name: 's' sketch { profiles { name: 'half' path { start { x: '-0.03' } "
      "segments { name: 'arc' to { x: '0.03' } through { y: '0.03' } } "
      "segments { name: 'base' to { x: '-0.03' } } } } } } "
      "features { name: 'body' extrude { sketch: 's' to: '0.01' } }",
      pi * 0.03 * 0.03 / 2 * 0.01);
}

TEST(FeatureVolume, PolygonIsMeasuredToItsSides) {
  ExpectVolume(
      "features { name: 's' sketch { profiles { name: 'hex' polygon { radius: '0.01' sides: '6' } "
      "} } } features { name: 'body' extrude { sketch: 's' to: '0.01' } }",
      2 * std::sqrt(3.0) * 0.01 * 0.01 * 0.01);
}

TEST(FeatureVolume, RevolvedRingWholeAndQuarter) {
  const std::string sketch =
      "features { name: 's' sketch { profiles { name: 'section' rectangle { center { x: '0.04' } "
      "width: '0.02' height: '0.01' } } } } ";
  const double ring = pi * (0.05 * 0.05 - 0.03 * 0.03) * 0.01;
  ExpectVolume(sketch +
                   "features { name: 'ring' revolve { sketch: 's' axis_direction { y: '1' } "
                   "} }",
               ring);
  ExpectVolume(sketch +
                   "features { name: 'ring' revolve { sketch: 's' axis_direction { y: '1' } "
                   "angle: 'pi / 2' } }",
               ring / 4);
}

TEST(FeatureVolume, SweptBendByPappus) {
  ExpectVolume(
      "features { name: 's' sketch { plane { normal { x: '1' } } profiles { name: 'round' circle { "
      "radius: '0.005' } } } } "
      "features { name: 'p' sketch { profiles { name: 'way' path { open: true "
      "segments { name: 'run' to { x: '0.03' } } "
      "segments { name: 'bend' to { x: '0.05' y: '0.02' } through { x: '0.03 + 0.02 * sin(pi / 4)' "
      "y: '0.02 - 0.02 * cos(pi / 4)' } } } } } } "
      "features { name: 'rod' sweep { sketch: 's' path: 'p' } }",
      pi * 0.005 * 0.005 * (0.03 + 0.02 * pi / 2));
}

// A section on either side of its axis, turned either way, and one that is swept against the way it
// looks: what is made and what is cut away is the same.
TEST(FeatureVolume, IsTheSameWhicheverWayASectionMoves) {
  const double ring = pi * (0.05 * 0.05 - 0.03 * 0.03) * 0.01;
  const std::string block =
      "features { name: 'b' sketch { profiles { name: 'o' rectangle { width: '0.2' height: '0.06' "
      "} } } } features { name: 'block' extrude { sketch: 'b' to: '0.1' } } ";
  const double block_volume = 0.2 * 0.06 * 0.1;
  for (const std::string side : {"", "-"}) {
    for (const std::string way : {"", "-"}) {
      const std::string section =
          "features { name: 's' sketch { profiles { name: 'r' rectangle { center { x: '" + side +
          "0.04' } width: '0.02' height: '0.01' } } } } ";
      const std::string turn =
          "features { name: 'ring' revolve { sketch: 's' axis_direction { y: '" + way + "1' } ";
      ExpectVolume(section + turn + "} }", ring);
      ExpectVolume(section + turn + "angle: 'pi / 2' } }", ring / 4);
      ExpectVolume(block + section + turn + "operation: CUT } }", block_volume - ring / 2);
      ExpectVolume(block + section + turn + "operation: UNITE } }", block_volume + ring / 2);
    }
    const std::string rod =
        "features { name: 's' sketch { plane { origin { z: '0.05' } normal { x: '1' } } profiles { "
        "name: 'c' circle { radius: '0.005' } } } } features { name: 'p' sketch { plane { origin { "
        "z: '0.05' } } profiles { name: 'w' path { open: true segments { name: 'run' to { x: '" +
        side + "0.15' } } } } } } ";
    const double section_area = pi * 0.005 * 0.005;
    const std::string sweep = "features { name: 'rod' sweep { sketch: 's' path: 'p' ";
    ExpectVolume(rod + sweep + "} }", section_area * 0.15);
    ExpectVolume(block + rod + sweep + "operation: CUT } }", block_volume - section_area * 0.1);
    ExpectVolume(block + rod + sweep + "operation: UNITE } }", block_volume + section_area * 0.05);
  }
}

TEST(FeatureVolume, BooleansOfBodies) {
  const std::string bodies =
      BlockText() +
      "features { name: 'rod_sketch' sketch { profiles { name: 'round' circle { center { x: "
      "'0.05' } radius: '0.01' } } } } "
      "features { name: 'rod' extrude { sketch: 'rod_sketch' to: '0.03' } } ";
  const double half = pi * 0.01 * 0.01 / 2 * 0.02;
  const double rod = pi * 0.01 * 0.01 * 0.03;
  const auto combine = [&](const std::string& operation) {
    return bodies + "features { name: 'both' boolean { operation: " + operation +
           " body: 'block' tools: 'rod' } }";
  };
  ExpectVolume(combine("UNITE"), kBlockVolume + rod - half);
  ExpectVolume(combine("CUT"), kBlockVolume - half);
  ExpectVolume(combine("INTERSECT"), half);
}

TEST(FeatureVolume, FilletAndChamferOfAnEdge) {
  ExpectVolume(BlockText() +
                   "features { name: 'f' fillet { edges: 'block.outline.right & "
                   "block.end' radius: '0.005' } }",
               kBlockVolume - (1 - pi / 4) * 0.005 * 0.005 * 0.06);
  ExpectVolume(BlockText() +
                   "features { name: 'c' chamfer { edges: 'block.outline.right & "
                   "block.end' distance: '0.004' } }",
               kBlockVolume - 0.004 * 0.004 / 2 * 0.06);
}

TEST(FeatureVolume, FilletOfAllUprightEdges) {
  ExpectVolume(BlockText() +
                   "features { name: 'f' fillet { edges: 'block.outline & block.outline' "
                   "radius: '0.01' } }",
               kBlockVolume - (4 - pi) * 0.01 * 0.01 * 0.02);
}

TEST(FeatureVolume, DraftMakesAFrustum) {
  const double lean = 0.02 * std::tan(0.1);
  const double top = (0.1 - 2 * lean) * (0.06 - 2 * lean), bottom = 0.1 * 0.06;
  const double middle = (0.1 - lean) * (0.06 - lean);  // Simpson's rule is exact for a prismatoid
  // From either end, and whether or not something has been done to the block before.
  for (const std::string neutral : {"block.start", "block.end"}) {
    const std::string draft = "features { name: 'd' draft { faces: 'block.outline' neutral: '" +
                              neutral + "' angle: '0.1' } }";
    ExpectVolume(BlockText() + draft, 0.02 / 6 * (top + 4 * middle + bottom));
    const std::string bore = "features { name: 'h' hole { face: 'block.end' diameter: '0.004' } } ";
    ExpectVolume(BlockText() + bore + draft,
                 0.02 / 6 * (top + 4 * middle + bottom) - pi * 0.002 * 0.002 * 0.02);
  }
}

TEST(FeatureVolume, ShellOpenAtTheTop) {
  ExpectVolume(
      BlockText() + "features { name: 'h' shell { open_faces: 'block.end' thickness: '0.003' } }",
      kBlockVolume - (0.1 - 0.006) * (0.06 - 0.006) * (0.02 - 0.003));
}

TEST(FeatureVolume, Holes) {
  const auto hole = [](const std::string& more) {
    return BlockText() +
           "features { name: 'h' hole { face: 'block.end' position { x: '0.01' z: "
           "'5' } diameter: '0.008' " +
           more + " } }";
  };
  const double round = pi * 0.004 * 0.004;
  ExpectVolume(hole(""), kBlockVolume - round * 0.02);
  ExpectVolume(hole("depth: '0.012'"), kBlockVolume - round * 0.012);
  ExpectVolume(hole("counterbore_diameter: '0.014' counterbore_depth: '0.005'"),
               kBlockVolume - round * 0.015 - pi * 0.007 * 0.007 * 0.005);
  // A cone of 90° from radius 7 mm to 4 mm is 3 mm deep.
  const double cone = pi / 3 * 0.003 * (0.007 * 0.007 + 0.007 * 0.004 + 0.004 * 0.004);
  ExpectVolume(hole("countersink_diameter: '0.014'"), kBlockVolume - round * 0.017 - cone);
}

TEST(FeatureVolume, PatternsInRowsGridsAndRings) {
  const std::string hole = BlockText() +
                           "features { name: 'h' hole { face: 'block.end' position { x: '-0.03' y: "
                           "'-0.01' } diameter: '0.006' } } ";
  const double one = pi * 0.003 * 0.003 * 0.02;
  ExpectVolume(hole +
                   "features { name: 'row' linear_pattern { feature: 'h' step { x: '0.015' } "
                   "count: '4' } }",
               kBlockVolume - 4 * one);
  ExpectVolume(hole +
                   "features { name: 'grid' linear_pattern { feature: 'h' step { x: '0.02' } "
                   "count: '3' second_step { y: '0.02' } second_count: '2' } }",
               kBlockVolume - 6 * one);
  ExpectVolume(hole + "features { name: 'ring' circular_pattern { feature: 'h' count: '2' } }",
               kBlockVolume - 2 * one);
}

TEST(FeatureVolume, RepeatedNewBodyIsUnited) {
  ExpectVolume(BlockText() +
                   "features { name: 'row' linear_pattern { feature: 'block' step { x: "
                   "'0.05' } count: '3' } }",
               2 * kBlockVolume);
}

TEST(FeatureVolume, SketchOnAFaceFollowsIt) {
  const auto model = ModelOf(TemplateText(
      Range("height", 0.01, 0.05, 0.03),
      "features { name: 's' sketch { profiles { name: 'o' rectangle { width: '0.1' height: '0.06' "
      "} } } } features { name: 'block' extrude { sketch: 's' to: 'height' } } "
      "features { name: 'knob_sketch' sketch { plane { face: 'block.end' origin { x: '0.02' } } "
      "profiles { name: 'round' circle { radius: '0.01' } } } } "
      "features { name: 'knob' extrude { sketch: 'knob_sketch' to: '0.005' operation: UNITE } }"));
  ASSERT_TRUE(model.ok()) << model.status();
  for (const double height : {0.01, 0.03, 0.05}) {
    const auto solid = model->Regenerate(Eigen::VectorXd::Constant(1, height));
    ASSERT_TRUE(solid.ok()) << solid.status();
    const double expected = 0.1 * 0.06 * height + pi * 0.01 * 0.01 * 0.005;
    EXPECT_NEAR(solid->solid.Volume(), expected, kRelative * expected);
    EXPECT_NEAR(solid->solid.CentreOfMass().x(), 0.02 * pi * 0.01 * 0.01 * 0.005 / expected, 1e-9);
  }
}

// Faces of a solid that nothing has been done to yet look out of it, too, whichever way the kernel
// made them: a hole goes in, what is drawn on them comes out.
TEST(FeatureVolume, HolesAndKnobsOnEverySideOfANewSolid) {
  const double disc = pi * 0.002 * 0.002;
  const auto drilled = [](const std::string& face, const std::string& at) {
    return "features { name: 'h' hole { face: '" + face + "' position { " + at +
           " } diameter: '0.004' depth: '0.003' } }";
  };
  for (const std::string role :
       {"start", "end", "outline.left", "outline.right", "outline.top", "outline.bottom"}) {
    const std::string face = "block." + role;
    ExpectVolume(BlockText() + drilled(face, "z: '0.01'"), kBlockVolume - disc * 0.003);
    ExpectVolume(BlockText() + "features { name: 'k' sketch { plane { face: '" + face +
                     "' origin { z: '0.01' } } profiles { name: 'o' circle { radius: '0.002' } } } "
                     "} features { name: 'knob' extrude { sketch: 'k' to: '0.005' operation: UNITE "
                     "} }",
                 kBlockVolume + disc * 0.005);
  }
  const double quarter = pi * (0.05 * 0.05 - 0.03 * 0.03) * 0.01 / 4;
  for (const std::string way : {"", "-"}) {
    const std::string ring =
        "features { name: 's' sketch { profiles { name: 'o' rectangle { center { x: '0.04' } "
        "width: '0.02' height: '0.01' } } } } features { name: 'ring' revolve { sketch: 's' "
        "axis_direction { y: '" +
        way + "1' } angle: 'pi / 2' } } ";
    const std::string middle = "x: '0.04 * cos(pi / 4)' z: '" +
                               std::string(way.empty() ? "-" : "") + "0.04 * sin(pi / 4)'";
    for (const std::string role : {"o.top", "o.bottom"}) {
      ExpectVolume(ring + drilled("ring." + role, middle), quarter - disc * 0.003);
    }
    ExpectVolume(ring + drilled("ring.start", "x: '0.04'"), quarter - disc * 0.003);
    ExpectVolume(ring + drilled("ring.end", "z: '" + std::string(way.empty() ? "-" : "") + "0.04'"),
                 quarter - disc * 0.003);
  }
}

TEST(SolidSurface, IsClosedAndNearTheSolid) {
  const auto model = SolidOf(
      "", BlockText() +
              "features { name: 'h' hole { face: 'block.end' diameter: '0.02' "
              "countersink_diameter: '0.03' } } features { name: 'f' fillet { edges: 'block.end & "
              "*' radius: '0.003' } }");
  // The countersink's rim is an edge of the top, too.
  ASSERT_TRUE(model.ok()) << model.status();
  const auto surface = SurfaceOf(model->solid, {.deflection = 1e-5});
  ASSERT_TRUE(surface.ok()) << surface.status();
  double volume = 0, area = 0;
  for (Eigen::Index i = 0; i < surface->triangles.cols(); ++i) {
    const Eigen::Vector3d a = surface->vertices.col(surface->triangles(0, i));
    const Eigen::Vector3d b = surface->vertices.col(surface->triangles(1, i));
    const Eigen::Vector3d c = surface->vertices.col(surface->triangles(2, i));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    area += normal.norm() / 2;
    volume += a.dot(normal) / 6;
  }
  EXPECT_NEAR(volume, model->solid.Volume(), 2e-3 * volume);
  EXPECT_NEAR(area, SurfaceArea(model->solid), 2e-3 * area);
  EXPECT_EQ(surface->faces.size(), model->origins.size());
  EXPECT_FALSE(SurfaceOf(model->solid, {.deflection = 0}).ok());
  EXPECT_FALSE(SurfaceOf(model->solid, {.relative_deflection = -1}).ok());
  EXPECT_FALSE(SurfaceOf(model->solid, {.deflection = 1e-3, .angle = 0}).ok());
}

TEST(FeatureModelSurface, ALargeSolidTakesNoMoreTrianglesThanASmallOne) {
  const auto triangles = [](const std::string& radius) -> Eigen::Index {
    const auto model = SolidOf(
        "", "features { name: 's' sketch { profiles { name: 'c' circle { radius: '" + radius +
                "' } } } } features { name: 'drum' extrude { sketch: 's' to: '" + radius + "' } }");
    if (!model.ok()) return 0;
    const auto surface = SurfaceOf(model->solid);
    return surface.ok() ? surface->triangles.cols() : 0;
  };
  EXPECT_GT(triangles("100"), 100);
  EXPECT_LT(triangles("100"), 1000);
}

TEST(FeatureModelExchange, GoesThroughStepUnchanged) {
  const auto model = SolidOf(
      "",
      BlockText() +
          "features { name: 'h' hole { face: 'block.end' diameter: '0.02' } } "
          "features { name: 'f' fillet { edges: 'block.outline & block.end' radius: '0.003' } }");
  ASSERT_TRUE(model.ok()) << model.status();
  const auto bytes = WriteStep("assembly", {{model->solid}});
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const auto read = ReadStep(*bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->parts.size(), 1U);
  EXPECT_EQ(read->parts[0].name, "Test");
  EXPECT_NEAR(read->parts[0].volume, model->solid.Volume(), 1e-6 * model->solid.Volume());
}

}  // namespace
}  // namespace mortise::cad
