#include "common/mesh/face_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::mesh {
namespace {

using Points = std::map<std::string, Eigen::Vector3d>;

FacedSurface FacesOf(const AssemblySurface& surface) {
  return OuterFaces(surface.vertices, surface.triangles, surface.triangle_face, surface.faces,
                    surface.part_names);
}

ControlVariables VariablesOf(const FacedSurface& surface, double spacing = 10) {
  auto variables = FindControlVariables(surface, spacing);
  EXPECT_TRUE(variables.ok()) << variables.status();
  return variables.ok() ? *variables : ControlVariables();
}

Points PointsOf(const ControlVariables& variables) {
  Points points;
  for (const auto& point : variables.points) {
    EXPECT_TRUE(points.emplace(point.name, point.position).second) << point.name;
  }
  return points;
}

std::set<std::string> EdgesOf(const ControlVariables& variables) {
  std::set<std::string> edges;
  for (const auto& path : variables.paths) edges.insert(path.edge);
  return edges;
}

// A prism along z over a convex outline, each side of which lies on the face of this name; caps are
// fans around their centres. `levels` divides the sides.
FacedSurface Prism(const Eigen::Matrix2Xd& outline, const std::vector<std::string>& names,
                   double height, int levels = 1) {
  const int n = static_cast<int>(outline.cols());
  FacedSurface prism;
  prism.vertices.resize(3, n * (levels + 1) + 2);
  for (int level = 0; level <= levels; ++level) {
    for (int i = 0; i < n; ++i) {
      prism.vertices.col(level * n + i) << outline.col(i), height * level / levels;
    }
  }
  prism.vertices.rightCols(2) << outline.rowwise().mean().replicate(1, 2),
      Eigen::RowVector2d(0, height);
  prism.face_names = names;
  prism.face_names.insert(prism.face_names.end(), {"base", "cap"});
  std::vector<Eigen::Vector3i> triangles;
  const auto add = [&](int a, int b, int c, int face) {
    triangles.emplace_back(a, b, c);
    prism.triangle_face.push_back(face);
  };
  const int bottom = n * (levels + 1), top = bottom + 1;
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    add(bottom, j, i, n);
    add(top, levels * n + i, levels * n + j, n + 1);
    for (int level = 0; level < levels; ++level) {
      const int below = level * n, above = below + n;
      add(below + i, below + j, above + j, i);
      add(below + i, above + j, above + i, i);
    }
  }
  prism.triangles.resize(3, std::ssize(triangles));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    prism.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return prism;
}

// An arc from one angle to another, both of which it has.
Eigen::Matrix2Xd Arc(double radius, double from, double to, int corners) {
  Eigen::Matrix2Xd arc(2, corners);
  for (int i = 0; i < corners; ++i) {
    const double angle = from + (to - from) * i / (corners - 1);
    arc.col(i) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return arc;
}

FacedSurface Cylinder(double radius, double height, int corners, double turned = 0) {
  const Eigen::Matrix2Xd outline =
      Arc(radius, turned, turned + 2 * M_PI * (corners - 1) / corners, corners);
  return Prism(outline, std::vector<std::string>(static_cast<std::size_t>(corners), "round"),
               height);
}

// The same surface with its triangles and vertices in another order.
FacedSurface Shuffled(const FacedSurface& surface) {
  std::mt19937 random(3);
  std::vector<int> triangle(surface.triangle_face.size()), vertex(surface.vertices.cols());
  for (auto* order : {&triangle, &vertex}) {
    for (std::size_t i = 0; i < order->size(); ++i) (*order)[i] = static_cast<int>(i);
    std::shuffle(order->begin(), order->end(), random);
  }
  FacedSurface shuffled = surface;
  for (std::size_t v = 0; v < vertex.size(); ++v) {
    shuffled.vertices.col(vertex[v]) = surface.vertices.col(static_cast<Eigen::Index>(v));
  }
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    shuffled.triangle_face[t] = surface.triangle_face[static_cast<std::size_t>(triangle[t])];
    for (int k = 0; k < 3; ++k) {
      shuffled.triangles(k, static_cast<Eigen::Index>(t)) =
          vertex[static_cast<std::size_t>(surface.triangles((k + 1) % 3, triangle[t]))];
    }
  }
  return shuffled;
}

TEST(FaceEdgesTest, ABoxHasItsCornersAndEdges) {
  const AssemblySurface box = AssembleBoxes({{"box", {0, 0, 0}, {4, 2, 1}}});
  const ControlVariables whole = VariablesOf(FacesOf(box));
  EXPECT_EQ(whole.paths.size(), 12u);
  const Points corners = PointsOf(whole);
  ASSERT_EQ(corners.size(), 8u);
  // Counter-clockwise seen from outside, from the lowest name on.
  EXPECT_EQ(corners.at("x_max | y_max | z_max"), Eigen::Vector3d(4, 2, 1));
  EXPECT_EQ(corners.at("x_max | z_max | y_min"), Eigen::Vector3d(4, 0, 1));
  for (const auto& point : whole.points) {
    EXPECT_EQ(box.vertices.col(point.vertex), point.position) << point.name;
  }
  const ControlVariables pieces = VariablesOf(FacesOf(box), 1);
  EXPECT_EQ(pieces.points.size(), 8u + 4 * (3 + 1));
  EXPECT_EQ(pieces.paths.size(), 4u * (4 + 2 + 1));
}

// What parts share inside of a table has no part in it, and all its parts have other names.
TEST(FaceEdgesTest, ATableKeepsItsNamesAtOtherSizes) {
  const FacedSurface table = FacesOf(TestTable());
  const FacedSurface other = FacesOf(TestTable(1.1, 0.7, 0.5, 0.07, 0.12, 0.04));
  const Points before = PointsOf(VariablesOf(table, 0.3));
  const Points after = PointsOf(VariablesOf(other, 0.3));
  EXPECT_GE(before.size(), 8u + 4 * 4) << "of the top, and of the feet";
  // Where a leg ends at the top is found on both, at the corner that it is of.
  const std::string foot = "leg0/x_min | leg0/y_min | leg0/z_min";
  int corners = 0;
  for (const auto& [name, place] : before) {
    if (name.find(" at ") != std::string::npos) continue;  // longer edges are halved more often
    const auto match = after.find(name);
    ASSERT_NE(match, after.end()) << name;
    ++corners;
    EXPECT_EQ(place.z() < 1e-12, match->second.z() < 1e-12) << name;
  }
  EXPECT_GE(corners, 8 + 4 * 4);
  EXPECT_EQ(before.count(foot) + before.count("leg0/x_min | leg0/z_min | leg0/y_min"), 1u);
}

TEST(FaceEdgesTest, NamesDoNotDependOnTheTriangles) {
  for (const FacedSurface& surface : {FacesOf(TestTable()), Cylinder(0.3, 1, 24)}) {
    const ControlVariables one = VariablesOf(surface, 0.2),
                           other = VariablesOf(Shuffled(surface), 0.2);
    const Points before = PointsOf(one), after = PointsOf(other);
    ASSERT_EQ(before.size(), after.size());
    for (const auto& [name, place] : before) {
      ASSERT_TRUE(after.contains(name)) << name;
      EXPECT_LT((after.at(name) - place).norm(), 1e-12) << name;
    }
    EXPECT_EQ(EdgesOf(one), EdgesOf(other));
  }
  const FacedSurface coarse = Cylinder(0.3, 1, 24);
  const FacedSurface fine = Cylinder(0.3, 1, 48);
  EXPECT_EQ(EdgesOf(VariablesOf(coarse)), EdgesOf(VariablesOf(fine)));
}

// Both corners of the cap of half a cylinder are between the same three faces; how these follow
// each other around it tells them apart.
TEST(FaceEdgesTest, TheOrderOfFacesTellsCornersApart) {
  std::vector<std::string> names(13, "round");
  names.back() = "flat";
  const Points points = PointsOf(VariablesOf(Prism(Arc(1, 0, M_PI, 13), names, 1, 3)));
  ASSERT_TRUE(points.contains("cap | flat | round"));
  ASSERT_TRUE(points.contains("cap | round | flat"));
  EXPECT_LT((points.at("cap | flat | round") - Eigen::Vector3d(1, 0, 1)).norm() *
                (points.at("cap | flat | round") - Eigen::Vector3d(-1, 0, 1)).norm(),
            1e-12);
  EXPECT_LT(
      (points.at("cap | flat | round") + points.at("cap | round | flat") - Eigen::Vector3d(0, 0, 2))
          .norm(),
      1e-12);
}

TEST(FaceEdgesTest, ClosedEdgesBeginOnAnAxisWhereverTheirTrianglesDo) {
  // Of a circle in the plane of x and y: at the largest x.
  for (const double turned : {0.0, 0.05, 0.4}) {
    const Points points = PointsOf(VariablesOf(Cylinder(2, 1, 40, turned)));
    ASSERT_EQ(points.size(), 8u);
    const Eigen::Vector3d begin = points.at("cap & round around from x at 0/1");
    const Eigen::Vector3d quarter = points.at("cap & round around from x at 1/4");
    EXPECT_LT((begin - Eigen::Vector3d(2, 0, 1)).norm(), 2 * (1 - std::cos(M_PI / 40)) + 1e-12);
    // With the cap, the lower name, on its left it goes counter-clockwise.
    EXPECT_LT((quarter - Eigen::Vector3d(0, 2, 1)).norm(), 0.02);
  }
}

TEST(FaceEdgesTest, WhatIsThereTwiceHasNoName) {
  // Two sides of a box are one face in two pieces: no corner or edge is of one of them only.
  const std::vector<std::string> names = {"front", "side", "back", "side"};
  Eigen::Matrix2Xd square(2, 4);
  square << 0, 1, 1, 0, 0, 0, 1, 1;
  const ControlVariables variables = VariablesOf(Prism(square, names, 1));
  // Corners are told apart by their order, sides of the caps by their ends.
  EXPECT_EQ(variables.points.size(), 8u);
  EXPECT_EQ(variables.paths.size(), 12u);
  const ControlVariables twins =
      VariablesOf(Prism(square, std::vector<std::string>{"a", "b", "a", "b"}, 1));
  EXPECT_TRUE(twins.points.empty());
  EXPECT_TRUE(twins.paths.empty());
}

TEST(FaceEdgesTest, SurfacesThatAreNotSoundHaveWhatIsSoundOfThem) {
  // Without one triangle, and with two boxes that touch in an edge: there names are none.
  FacedSurface open = FacesOf(AssembleBoxes({{"box", {0, 0, 0}, {4, 2, 1}}}));
  open.triangles.conservativeResize(3, open.triangles.cols() - 1);
  open.triangle_face.pop_back();
  EXPECT_LT(VariablesOf(open).points.size(), 8u);
  EXPECT_GE(VariablesOf(open).points.size(), 4u);
  const FacedSurface pair =
      FacesOf(AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}, {"b", {1, 1, 0}, {2, 2, 1}}}));
  const Points points = PointsOf(VariablesOf(pair));
  EXPECT_EQ(points.size(), 12u);
  for (const auto& [name, place] : points) {
    EXPECT_GT((place - Eigen::Vector3d(1, 1, place.z())).norm(), 0.1) << name;
  }
}

TEST(FaceEdgesTest, SpacingsThatAreNoneAreRefused) {
  const FacedSurface box = FacesOf(AssembleBoxes({{"box", {0, 0, 0}, {4, 2, 1}}}));
  for (const double spacing : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(DetailOf(FindControlVariables(box, spacing).status()).field, "spacing");
  }
  EXPECT_TRUE(absl::IsResourceExhausted(FindControlVariables(box, 1e-9).status()));
  EXPECT_TRUE(VariablesOf(FacedSurface()).points.empty());
}

}  // namespace
}  // namespace mortise::mesh
