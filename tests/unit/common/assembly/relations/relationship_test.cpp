// What must stay true of a design: which relationships are found, where they are held, and that
// they keep designs sound where boxes, rows and rest poses make it hard.
#include "common/assembly/relations/relationship.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include "common/assembly/parametric_assembly.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/expect_sound.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kRightAngle = std::numbers::pi / 2;

std::vector<std::string> Descriptions(const ParametricAssembly& assembly) {
  std::vector<std::string> descriptions;
  for (const Relationship& relationship : assembly.relationships()) {
    descriptions.push_back(relationship.description);
  }
  return descriptions;
}

// Where the relationship of this description is held.
std::string GroupOf(const ParametricAssembly& assembly, const std::string& description) {
  for (const Relationship& relationship : assembly.relationships()) {
    if (relationship.description != description) continue;
    return assembly.assembly().groups[static_cast<std::size_t>(relationship.group)].name;
  }
  return "none";
}

TEST(RelationshipTest, APostBetweenSlatsStaysBetweenThem) {
  Assembly fence = Named("fence", {});
  for (int i = 0; i < 5; ++i) {
    fence.parts.push_back(
        ResizablePart("slat " + std::to_string(i), {0.2 * i, 0, 0}, {0.2 * i + 0.05, 0.02, 1}));
  }
  fence.parts.push_back(ResizablePart("post", {0.1, 0, 0}, {0.15, 0.02, 1.5}));
  fence.parts.push_back(ResizablePart("rail", {0, 0.02, 0.4}, {0.85, 0.04, 0.5}));
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(fence));
  ExpectSound(made);
}

// Two kinds of boards in turn: as their numbers changed, they would stand in each other.
TEST(RelationshipTest, RowsThatInterlaceStayApart) {
  Assembly screen = Named("screen", {});
  for (int i = 0; i < 4; ++i) {
    const double at = 0.2 * i;
    screen.parts.push_back(
        ResizablePart("wide " + std::to_string(i), {at, 0, 0}, {at + 0.08, 0.02, 1}));
    screen.parts.push_back(
        ResizablePart("slim " + std::to_string(i), {at + 0.12, 0, 0}, {at + 0.15, 0.02, 1}));
  }
  screen.parts.push_back(ResizablePart("rail", {0, 0.02, 0.4}, {0.75, 0.04, 0.5}));
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(screen));
  ExpectSound(made);
}

// Planks that could be sawn narrower, each held by a screw: a plank keeps its width, and its screw.
TEST(RelationshipTest, WhatIsFastenedPartByPartStaysSo) {
  Assembly deck = Named("deck", {ResizablePart("beam 1", {0, 0, 0}, {0.05, 0.8, 0.1}),
                                 ResizablePart("beam 2", {1.15, 0, 0}, {1.2, 0.8, 0.1})});
  for (int i = 0; i < 5; ++i) {
    const double at = 0.16 * i;
    deck.parts.push_back(
        ResizablePart("plank " + std::to_string(i), {0, at, 0.1}, {1.2, at + 0.14, 0.12}));
    deck.parts.push_back(FixedPart("screw " + std::to_string(i), {0.023, at + 0.068, 0.06},
                                   {0.027, at + 0.072, 0.12}));
    deck.parts.back().connecting = true;
    deck.parts.back().item = "items/screw";
  }
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(deck));
  ExpectSound(made);
}

// A box on the third shelf, one under the fifth, and a partition between two others.
TEST(RelationshipTest, WhatStandsOnOneShelfStaysOnIt) {
  Assembly rack = Named("rack", {ResizablePart("left", {0, 0, 0}, {0.02, 0.3, 1.6}),
                                 ResizablePart("right", {0.98, 0, 0}, {1, 0.3, 1.6})});
  for (int i = 0; i < 5; ++i) {
    const double at = 0.3 * i + 0.1;
    rack.parts.push_back(
        ResizablePart("shelf " + std::to_string(i), {0.02, 0, at}, {0.98, 0.3, at + 0.02}));
    rack.parts.back().item = "items/shelf";
  }
  rack.parts.push_back(ResizablePart("box", {0.2, 0.1, 0.72}, {0.4, 0.2, 0.85}));
  rack.parts.push_back(ResizablePart("lamp", {0.6, 0.1, 1.25}, {0.7, 0.2, 1.3}));
  rack.parts.push_back(ResizablePart("partition", {0.5, 0, 0.12}, {0.52, 0.3, 0.4}));
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(rack));
  ExpectSound(made);
}

// Steps between two stringers, up a slope: as many and as large as both of its lengths allow.
TEST(RelationshipTest, StepsOfAStairKeepTheirSize) {
  Assembly stair = Named("stair", {ResizablePart("left", {0, 0, 0}, {0.04, 1.5, 1.2}),
                                   ResizablePart("right", {0.84, 0, 0}, {0.88, 1.5, 1.2})});
  for (int i = 0; i < 6; ++i) {
    const double at = 0.22 * i, up = 0.17 * i + 0.15;
    stair.parts.push_back(
        ResizablePart("step " + std::to_string(i), {0.04, at, up}, {0.84, at + 0.25, up + 0.04}));
    stair.parts.back().item = "items/step";
  }
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(stair));
  ExpectSound(made);
}

// It lies in the angle's box without touching it; the plate under both holds it.
TEST(RelationshipTest, WhatLiesInAnothersBoxStaysClearOfIt) {
  Assembly corner = Named("corner", {ResizablePart("angle", {0, 0, 0}, {0.04, 0.04, 0.1}),
                                     ResizablePart("block", {0.008, 0.009, 0}, {0.03, 0.03, 0.1}),
                                     ResizablePart("plate", {0, 0, -0.01}, {0.04, 0.04, 0})});
  corner.parts[0].shape = Angle();
  corner.parts[0].prominent_planes = {{"leg along y", Axis::kX, 0.004},
                                      {"leg along x", Axis::kY, 0.004}};
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(corner));
  EXPECT_THAT(Descriptions(made), Contains("'angle' leg along y before 'block' x minimum"));
  ExpectSound(made);
}

// A door drawn open; closed, it lies against a stop, which must not slide off it.
TEST(RelationshipTest, ContactsOfARestPoseAreKept) {
  Assembly gate = Named("gate", {ResizablePart("post", {0, 0, 0}, {0.05, 0.05, 1}),
                                 ResizablePart("sill", {0, 0, -0.02}, {0.6, 0.05, 0}),
                                 ResizablePart("stop", {0.5, 0.025, 0}, {0.55, 0.045, 0.05}),
                                 ResizablePart("door", {0.05, 0.025, 0}, {0.07, 0.525, 1}, 1)});
  gate.groups.push_back({"wing", 0});
  Joint hinge;
  hinge.name = "hinge";
  hinge.group = 1;
  hinge.center = {0.05, 0.025, 0.5};
  hinge.axis = Eigen::Vector3d::UnitZ();
  hinge.lower = -kRightAngle;
  hinge.upper = 0;
  hinge.rest_poses = {{"closed", {0, 0, -kRightAngle}}};
  gate.joints = {hinge};
  ASSERT_THAT(ValidateAssembly(gate), IsEmpty());
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(gate));
  ExpectSound(made);
}

// A drawer in a box: its front stands before the sides, drawn shut and pulled out.
Assembly BoxWithDrawer() {
  Assembly box = Named("box", {ResizablePart("left", {0, 0, 0}, {0.02, 0.4, 0.2}),
                               ResizablePart("right", {0.48, 0, 0}, {0.5, 0.4, 0.2}),
                               ResizablePart("bottom", {0.02, 0, 0}, {0.48, 0.4, 0.02}),
                               ResizablePart("front", {0, -0.02, 0}, {0.5, 0, 0.2}, 1),
                               ResizablePart("tray", {0.03, 0, 0.02}, {0.47, 0.38, 0.1}, 1)});
  box.groups.push_back({"drawer", 0});
  Joint slide;
  slide.name = "slide";
  slide.kind = JointKind::kPrismatic;
  slide.group = 1;
  slide.axis = -Eigen::Vector3d::UnitY();
  slide.lower = 0;
  slide.upper = 0.3;
  box.joints = {slide};
  return box;
}

// A slide without rest poses is looked at at both its ends.
TEST(RelationshipTest, ADrawerIsSoundShutAndPulledOut) {
  const Assembly box = BoxWithDrawer();
  ASSERT_THAT(ValidateAssembly(box), IsEmpty());
  const std::vector<Pose> poses = PosesOf(box);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].name, "slide: upper limit");
  EXPECT_NEAR((poses[1].motion - Eigen::Vector3d(0, -0.3, 0)).norm(), 0, 1e-15);
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(box));
  ExpectSound(made);
}

// A lamp's arm on a ball, turned a quarter about two axes in turn.
TEST(RelationshipTest, ABallIsSoundInEachOfItsPoses) {
  Assembly lamp = Named("lamp", {ResizablePart("foot", {-0.1, -0.1, 0}, {0.1, 0.1, 0.02}),
                                 ResizablePart("stem", {-0.01, -0.01, 0.02}, {0.01, 0.01, 0.5}),
                                 ResizablePart("arm", {-0.01, -0.01, 0.5}, {0.01, 0.01, 0.8}, 1)});
  lamp.groups.push_back({"head", 0});
  Joint ball;
  ball.name = "ball";
  ball.kind = JointKind::kBall;
  ball.group = 1;
  ball.center = {0, 0, 0.51};
  ball.upper = 2;
  ball.rest_poses = {{"to the front", {kRightAngle, 0, 0}}, {"aside", {0, kRightAngle, 0}}};
  lamp.joints = {ball};
  ASSERT_THAT(ValidateAssembly(lamp), IsEmpty());
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(lamp));
  EXPECT_EQ(PosesOf(lamp).size(), 3U);
  ExpectSound(made);
}

// How far a box reaches in a pose is linear in q, turned however.
TEST(RestPoseTest, ReachesAsFarAsTheFurthestCorner) {
  Assembly chest = ChestWithLid();
  chest.joints[0].rest_poses[0].motion = {-0.7, 0, 0};
  const std::vector<Element> elements = MakeElements(chest, 1e-6);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  Eigen::VectorXd q = DrawnParameters(chest, elements);
  for (int round = 0; round < 50; ++round) {
    for (double& value : q) value = uniform(random);
    const Eigen::Vector3d direction =
        Eigen::Vector3d(uniform(random), -uniform(random), uniform(random)).normalized();
    for (const Pose& pose : PosesOf(chest)) {
      const Eigen::Isometry3d motion = MotionIn(pose, chest, elements.size(), q);
      for (int e = 0; e < static_cast<int>(elements.size()); ++e) {
        const Eigen::Vector3d center = q.segment<3>(CenterVariable(e, Axis::kX));
        const Eigen::Vector3d half = q.segment<3>(SizeVariable(e, Axis::kX)) / 2;
        double furthest = -1e9;
        for (int corner = 0; corner < 8; ++corner) {
          Eigen::Vector3d point = center;
          for (int axis = 0; axis < 3; ++axis) {
            point[axis] += (corner >> axis & 1 ? 1 : -1) * half[axis];
          }
          if (MovesIn(pose, chest, elements[static_cast<std::size_t>(e)])) point = motion * point;
          furthest = std::max(furthest, direction.dot(point));
        }
        EXPECT_NEAR(ReachIn(pose, chest, elements, e, direction).At(q), furthest, 1e-12);
      }
    }
  }
}

// As a person types it, a right angle is one.
// A lever that turns about a pin in it, or beside it.
Assembly Lever(double pin) {
  Assembly lever = Named("swing", {ResizablePart("base", {0, 0, -0.02}, {0.3, 0.1, 0}),
                                   ResizablePart("lever", {0, 0, 0}, {0.2, 0.08, 0.02})});
  lever.groups.push_back({"turning", 0});
  lever.parts[1].group = 1;
  Joint joint;
  joint.name = "pin";
  joint.kind = JointKind::kHinge;
  joint.group = 1;
  joint.center = {pin, 0.04, 0.01};
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.upper = std::numbers::pi / 2;
  lever.joints = {joint};
  return lever;
}

TEST(RelationshipTest, AJointInAPartKeepsItsShareOfIt) {
  ASSERT_OK_AND_ASSIGN(const auto within, ParametricAssembly::Create(Lever(0.05)));
  ASSERT_OK_AND_ASSIGN(const auto beside, ParametricAssembly::Create(Lever(-0.01)));
  const int size = SizeVariable(1, Axis::kX), center = CenterVariable(1, Axis::kX);
  const int pin = JointVariable(2, 0, Axis::kX);
  ASSERT_OK_AND_ASSIGN(const std::vector<Eigen::VectorXd> samples, within.Sample(20, 3));
  double shortest = 1, longest = 0;
  for (const Eigen::VectorXd& q : samples) {
    EXPECT_NEAR((q[pin] - (q[center] - q[size] / 2)) / q[size], 0.25, 1e-9);
    shortest = std::min(shortest, q[size]);
    longest = std::max(longest, q[size]);
  }
  EXPECT_GT(longest - shortest, 0.02) << "or nothing is shown";
  ASSERT_OK_AND_ASSIGN(const std::vector<Eigen::VectorXd> others, beside.Sample(20, 3));
  for (const Eigen::VectorXd& q : others) {
    EXPECT_NEAR(q[center] - q[size] / 2 - q[pin], 0.01, 1e-9);
  }
}

TEST(RelationshipTest, AnAngleTypedByHandFreezesNothing) {
  const auto freedoms = [](double angle) {
    Assembly chest = ChestWithLid();
    chest.joints[0].rest_poses[0].motion = {-angle, 0, 0};
    const auto made = ParametricAssembly::Create(chest);
    EXPECT_TRUE(made.ok()) << made.status();
    return made->feasible_set().degrees_of_freedom();
  };
  const int exact = freedoms(kRightAngle);
  EXPECT_EQ(freedoms(1.5708), exact);
  EXPECT_EQ(freedoms(1.570796), exact);
}

TEST(RelationshipTest, ProminentPlanesAreTied) {
  // A shelf on a ledge that is no face of the wall's box.
  Assembly niche = Named("niche", {ResizablePart("wall", {0, 0, 0}, {0.1, 1, 2}),
                                   ResizablePart("shelf", {0.1, 0, 0.8}, {0.4, 1, 0.83})});
  niche.parts[0].prominent_planes = {{"ledge", Axis::kZ, 0.8}};
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(niche));
  EXPECT_THAT(Descriptions(made),
              Contains(AllOf(HasSubstr("'wall' ledge"), HasSubstr("in one plane with"),
                             HasSubstr("'shelf' z minimum"))));
  ASSERT_OK_AND_ASSIGN(const Adjustment higher,
                       made.Adjust(made.drawn(), {{{"wall", Axis::kZ}, 3}}, DemandPolicy::kStrict));
  for (const PlacedPart& part : made.PartsAt(higher.q)) {
    if (part.name == "shelf") {
      EXPECT_NEAR(part.box.minimum.z(), 1.2, 1e-9);
    }
  }
}

// A bought handle comes with its threads: wherever it goes, and however wide the front is, its two
// screws are where these are.
TEST(RelationshipTest, ScrewsStayInTheThreadsOfABoughtHandle) {
  const auto fastener = [](const char* name, const Eigen::Vector3d& low,
                           const Eigen::Vector3d& size) {
    AssemblyPart part = FixedPart(name, low, low + size);
    part.item = std::string("items/") + name;
    part.item_axes = {Axis::kY, Axis::kX, Axis::kZ};
    part.connecting = true;
    return part;
  };
  Assembly drawer =
      Named("drawer", {ResizablePart("front", {0, 0, 0}, {0.4, 0.018, 0.2}),
                       fastener("handle", {0.12, -0.03, 0.09}, {0.16, 0.03, 0.02}),
                       fastener("left screw", {0.136, -0.012, 0.096}, {0.008, 0.036, 0.008}),
                       fastener("right screw", {0.250, -0.012, 0.097}, {0.008, 0.036, 0.008})});
  drawer.parts[0].item = "items/panel";
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(drawer));
  ASSERT_OK_AND_ASSIGN(std::vector<Eigen::VectorXd> designs, made.Sample(20, 1));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment wider,
      made.Adjust(made.drawn(), {{{"front", Axis::kX}, 0.7}}, DemandPolicy::kStrict));
  designs.push_back(wider.q);
  for (const Eigen::VectorXd& q : designs) {
    std::map<std::string, Eigen::Vector3d> center;
    for (const PlacedPart& part : made.PartsAt(q)) center[part.name] = part.box.center();
    for (const auto& [screw, x, z] :
         {std::tuple("left screw", -0.06, 0.0), std::tuple("right screw", 0.054, 0.001)}) {
      EXPECT_NEAR(center[screw].x() - center["handle"].x(), x, 1e-9);
      EXPECT_NEAR(center[screw].z() - center["handle"].z(), z, 1e-9);
    }
  }
}

// Of two elements between which a pair is centred, the sibling is the middle.
TEST(RelationshipTest, MirrorsAreLookedForAmongSiblingsFirst) {
  Assembly cart = Named("cart", {ResizablePart("wheel 1", {-0.5, 0, 0}, {-0.45, 0.3, 0.3}, 1),
                                 ResizablePart("wheel 2", {0.45, 0, 0}, {0.5, 0.3, 0.3}, 1),
                                 ResizablePart("axle", {-0.45, 0.1, 0.1}, {0.45, 0.2, 0.2}, 1),
                                 ResizablePart("bed", {-0.4, 0, 0.3}, {0.4, 0.3, 0.35}, 0)});
  cart.parts[2].item = "items/rod";
  cart.parts[3].item = "items/panel";
  cart.groups.push_back({"chassis", 0});
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(cart));
  EXPECT_EQ(GroupOf(made, "'wheel 1' and 'wheel 2' mirrored along x about 'axle'"), "chassis");
  // If it is no sibling, what the group above has is taken, and held there.
  cart.parts[2].group = 0;
  ASSERT_OK_AND_ASSIGN(const auto without, ParametricAssembly::Create(cart));
  EXPECT_EQ(GroupOf(without, "'wheel 1' and 'wheel 2' mirrored along x about 'axle'"), "cart");
}

// Every relationship is held by a group that contains all it speaks of, and by no higher one.
TEST(RelationshipTest, EachIsHeldByTheLowestGroupAboveAllItRelates) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Assembly assembly = seed == 0 ? ChestWithLid() : RandomAssembly(seed);
    const std::vector<Element> elements = MakeElements(assembly, 1e-6);
    const auto elements_end = static_cast<int>(6 * elements.size());
    for (const Relationship& relationship :
         FindRelationships(assembly, elements, TouchingPairs(elements), 1e-6)) {
      int lowest = -1;
      for (const LinearTerm& term : relationship.form.terms) {
        const int group =
            term.variable < elements_end
                ? elements[static_cast<std::size_t>(term.variable / 6)].group
                : assembly
                      .groups[static_cast<std::size_t>(
                          assembly
                              .joints[static_cast<std::size_t>((term.variable - elements_end) / 3)]
                              .group)]
                      .parent;  // a joint's centre lives beside what it moves
        lowest = lowest < 0 ? group : LowestCommonGroup(assembly, lowest, group);
      }
      // A mirrored pair is as large as each other because of what it is mirrored about.
      if (relationship.kind == RelationshipKind::kSymmetric &&
          relationship.form.terms.size() == 2) {
        EXPECT_TRUE(IsWithin(assembly, lowest, relationship.group)) << relationship.description;
        continue;
      }
      EXPECT_EQ(relationship.group, lowest) << seed << ": " << relationship.description;
    }
  }
}

}  // namespace
}  // namespace mortise::parametric
