// Linear templates at parameters: parts where q says, meshes that are linear in it.
#include "common/assembly/model/linear_design.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/feasible_set.h"
#include "common/assembly/relations/principal_patterns.h"
#include "common/assembly/relations/relationship.h"
#include "common/mesh/mass_properties.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

constexpr double kTolerance = 1e-6;

TEST(LinearDesign, TheDrawnParametersGiveTheDrawnDesign) {
  for (const Assembly& assembly :
       {TwoLeggedTable(), ChestWithLid(), RandomAssembly(1), RandomAssembly(2)}) {
    const std::vector<Element> elements = MakeElements(assembly, kTolerance);
    const auto parts = PlaceParts(assembly, elements, DrawnParameters(assembly, elements));
    ASSERT_EQ(parts.size(), assembly.parts.size());
    for (const PlacedPart& placed : parts) {
      const auto drawn =
          std::find_if(assembly.parts.begin(), assembly.parts.end(),
                       [&](const AssemblyPart& part) { return part.name == placed.name; });
      ASSERT_NE(drawn, assembly.parts.end()) << placed.name;
      EXPECT_TRUE(placed.box.minimum.isApprox(drawn->box.minimum, 1e-9)) << placed.name;
      EXPECT_TRUE(placed.box.maximum.isApprox(drawn->box.maximum, 1e-9)) << placed.name;
    }
  }
}

TEST(LinearDesign, APatternThatGrowsHasMoreParts) {
  const Assembly chest = ChestWithLid();
  const std::vector<Element> elements = MakeElements(chest, kTolerance);
  ASSERT_EQ(elements[0].parts.size(), 3U) << "the shelves";
  Eigen::VectorXd q = DrawnParameters(chest, elements);
  q[SizeVariable(0, Axis::kZ)] *= 2;
  const auto parts = PlaceParts(chest, elements, q);
  EXPECT_GT(parts.size(), chest.parts.size());
  std::set<std::string> names;
  double highest = 0;
  for (const PlacedPart& part : parts) {
    EXPECT_TRUE(names.insert(part.name).second) << part.name;
    if (part.element == 0) highest = std::max(highest, part.box.maximum.z());
  }
  EXPECT_NEAR(highest, BoxOf(q, 0).maximum.z(), 1e-12) << "the pattern fills its box";
}

// A deck of boards almost side by side, a screw through each: both rows keep as many parts, one on
// the other, though only boards can run into each other.
TEST(LinearDesign, WhatFastensARowPartByPartFollowsIt) {
  Assembly deck;
  deck.name = "deck";
  deck.groups = {{"deck", -1}};
  for (int i = 0; i < 6; ++i) {
    const double y = 0.145 * i;
    const std::string number = std::to_string(i + 1);
    deck.parts.push_back(FixedPart("board " + number, {0, y, 0}, {1, y + 0.14, 0.02}));
    deck.parts.push_back(
        FixedPart("screw " + number, {0.05, y + 0.068, -0.02}, {0.054, y + 0.072, 0.02}));
    deck.parts.back().item = "items/screw";
    deck.parts.back().connecting = true;
  }
  std::vector<Element> elements = MakeElements(deck, kTolerance);
  ASSERT_EQ(elements.size(), 2U);
  const Contacts contacts = TouchingPairs(elements);
  FollowPrincipalPatterns(elements, contacts, kTolerance);
  const auto set =
      FeasibleSet::Create(FindRelationships(deck, elements, contacts, kTolerance),
                          DrawnParameters(deck, elements), VariablesWithin(deck, elements, 0));
  ASSERT_TRUE(set.ok()) << set.status();
  const int boards = elements[0].connecting ? 1 : 0;
  std::set<std::size_t> counts;
  for (double width = 0.51; width < 1.59; width += 0.0131) {
    const auto q = set->Nearest(
        set->drawn(),
        {{LinearForm::Variable(SizeVariable(boards, Axis::kY)), width, "width of the deck"}});
    ASSERT_TRUE(q.ok()) << q.status();
    std::vector<BoundingBox> rows[2];
    for (const PlacedPart& part : PlaceParts(deck, elements, *q)) {
      rows[part.element == boards ? 0 : 1].push_back(part.box);
    }
    ASSERT_EQ(rows[0].size(), rows[1].size()) << width;
    for (std::size_t i = 0; i < rows[0].size(); ++i) {
      EXPECT_NEAR(rows[0][i].center().y(), rows[1][i].center().y(), 1e-9);
      if (i > 0) {
        EXPECT_GE(rows[0][i].minimum.y(), rows[0][i - 1].maximum.y() - 1e-8);
      }
    }
    counts.insert(rows[0].size());
  }
  EXPECT_GT(counts.size(), 5U) << "the rows shrank and grew";
}

// Vertices at a mixture of parameters are the mixture of the vertices.
TEST(LinearDesign, MeshesAreLinear) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  const auto any_box = [&] {
    const Eigen::Vector3d corner(uniform(random), uniform(random), uniform(random));
    return BoundingBox{corner,
                       corner + Eigen::Vector3d(uniform(random), uniform(random), uniform(random))};
  };
  const BoundingBox drawn = any_box();
  mesh::SurfaceMesh surface = SurfaceOf(drawn);
  // Something that is no box: one corner pushed in.
  surface.vertices.col(3) = 0.9 * surface.vertices.col(3) + 0.1 * drawn.center();
  const auto shape = mesh::ShapeOfMesh(surface);
  ASSERT_TRUE(shape.ok()) << shape.status();
  const auto vertices_in = [&](const BoundingBox& box) {
    return SurfaceIn(*shape, box.center(), box.size()).vertices;
  };
  EXPECT_TRUE(vertices_in(drawn).isApprox(surface.vertices, 1e-12));
  for (int round = 0; round < 20; ++round) {
    const BoundingBox a = any_box();
    const BoundingBox b = any_box();
    const double share = uniform(random);
    const BoundingBox mixed{share * a.minimum + (1 - share) * b.minimum,
                            share * a.maximum + (1 - share) * b.maximum};
    EXPECT_TRUE(
        vertices_in(mixed).isApprox(share * vertices_in(a) + (1 - share) * vertices_in(b), 1e-12));
    EXPECT_TRUE(vertices_in(a).rowwise().minCoeff().isApprox(a.minimum, 1e-12));
    EXPECT_TRUE(vertices_in(a).rowwise().maxCoeff().isApprox(a.maximum, 1e-12));
  }
}

TEST(LinearDesign, BoxesAreClosedOutwardAndOfTheirVolume) {
  const BoundingBox box{{0.1, -0.2, 0.3}, {0.6, 0.2, 0.5}};
  const mesh::SurfaceMesh surface = SurfaceOf(box);
  EXPECT_NEAR(mesh::ComputeMassProperties(surface).volume, 0.5 * 0.4 * 0.2, 1e-12);
  std::multiset<std::pair<int, int>> edges;
  for (const auto& triangle : surface.triangles.colwise()) {
    for (int i = 0; i < 3; ++i) edges.insert({triangle[i], triangle[(i + 1) % 3]});
  }
  for (const auto& [from, to] : edges) {
    EXPECT_EQ(edges.count({from, to}), 1U);
    EXPECT_EQ(edges.count({to, from}), 1U);
  }
}

// The motion of a pose takes the centres where the relationships say that they are.
TEST(LinearDesign, PosesMovePartsAsTheRelationshipsSay) {
  const Assembly chest = ChestWithLid();
  const std::vector<Element> elements = MakeElements(chest, kTolerance);
  std::mt19937 random(4);
  std::normal_distribution<double> normal(0, 0.1);
  for (int round = 0; round < 10; ++round) {
    Eigen::VectorXd q = DrawnParameters(chest, elements);
    for (double& entry : q) entry += normal(random);
    for (const Pose& pose : PosesOf(chest)) {
      const Eigen::Isometry3d motion = MotionIn(pose, chest, elements.size(), q);
      for (const PosedPosition& posed : PositionsIn(pose, chest, elements)) {
        if (!posed.is_center) continue;
        const int group = elements[static_cast<std::size_t>(posed.element)].group;
        const bool moved = pose.joint >= 0 && IsWithin(chest, group, pose.moved_group);
        const Eigen::Vector3d center = BoxOf(q, posed.element).center();
        const Eigen::Vector3d expected = moved ? Eigen::Vector3d(motion * center) : center;
        EXPECT_NEAR(posed.position.At(q), expected[static_cast<int>(posed.axis)], 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace mortise::parametric
