// Small assemblies for the tests of automatic parametrisation.
#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::parametric {

// A part whose sizes may halve or double.
inline AssemblyPart ResizablePart(const std::string& name, const Eigen::Vector3d& minimum,
                                  const Eigen::Vector3d& maximum, int group = 0) {
  AssemblyPart part;
  part.name = name;
  part.item = "items/board";
  part.group = group;
  part.box = {minimum, maximum};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = maximum[axis] - minimum[axis];
    part.limits[static_cast<std::size_t>(axis)] = {size / 2, 2 * size};
  }
  return part;
}

inline AssemblyPart FixedPart(const std::string& name, const Eigen::Vector3d& minimum,
                              const Eigen::Vector3d& maximum, int group = 0) {
  AssemblyPart part = ResizablePart(name, minimum, maximum, group);
  for (int axis = 0; axis < 3; ++axis) {
    const double size = maximum[axis] - minimum[axis];
    part.limits[static_cast<std::size_t>(axis)] = {size, size};
  }
  return part;
}

// Parts in one group.
inline Assembly Named(const std::string& name, std::vector<AssemblyPart> parts) {
  Assembly assembly;
  assembly.name = name;
  assembly.groups = {{name, -1}};
  assembly.parts = std::move(parts);
  return assembly;
}

// The table of Figure 3-4: a top on two inset legs, all as deep as each other.
inline Assembly TwoLeggedTable() {
  Assembly table;
  table.name = "table";
  table.groups = {{"table", -1}};
  table.parts = {ResizablePart("top", {-0.5, 0, 0.70}, {0.5, 0.4, 0.74}),
                 ResizablePart("leg 1", {-0.4, 0, 0}, {-0.34, 0.4, 0.70}),
                 ResizablePart("leg 2", {0.34, 0, 0}, {0.4, 0.4, 0.70})};
  table.parts[0].item = "items/panel";
  return table;
}

// A case of two sides, a bottom and a lid that hinges up about its back edge; three equal shelves
// in a group of their own inside the case.
inline Assembly ChestWithLid() {
  Assembly chest;
  chest.name = "chest";
  chest.groups = {{"chest", -1}, {"case", 0}, {"shelves", 1}, {"lid", 0}};
  chest.parts = {ResizablePart("left side", {0, 0, 0}, {0.02, 0.5, 0.6}, 1),
                 ResizablePart("right side", {0.98, 0, 0}, {1.0, 0.5, 0.6}, 1),
                 ResizablePart("bottom", {0.02, 0, 0}, {0.98, 0.5, 0.02}, 1),
                 ResizablePart("shelf 1", {0.02, 0, 0.14}, {0.98, 0.5, 0.16}, 2),
                 ResizablePart("shelf 2", {0.02, 0, 0.29}, {0.98, 0.5, 0.31}, 2),
                 ResizablePart("shelf 3", {0.02, 0, 0.44}, {0.98, 0.5, 0.46}, 2),
                 ResizablePart("lid board", {0, 0, 0.6}, {1.0, 0.5, 0.62}, 3)};
  Joint hinge;
  hinge.name = "lid hinge";
  hinge.group = 3;
  hinge.center = {0.5, 0.5, 0.61};
  hinge.axis = Eigen::Vector3d::UnitX();
  hinge.lower = -1.6;
  hinge.upper = 0;
  hinge.rest_poses = {{"open", {-std::acos(0.0), 0, 0}}};
  chest.joints = {hinge};
  return chest;
}

// An L of 40 mm × 40 mm, 4 mm thick and 100 mm long along z, in its box.
inline std::shared_ptr<const mesh::DrawnShape> Angle() {
  const double outline[][2] = {{0, 0},         {0.04, 0},     {0.04, 0.004},
                               {0.004, 0.004}, {0.004, 0.04}, {0, 0.04}};
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 12);
  for (int i = 0; i < 6; ++i) {
    surface.vertices.col(i) << outline[i][0], outline[i][1], 0;
    surface.vertices.col(6 + i) << outline[i][0], outline[i][1], 0.1;
  }
  surface.triangles.resize(3, 20);
  surface.triangles << 2, 6, 3, 6, 4, 6, 5, 6, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5,  //
      1, 7, 2, 8, 3, 9, 4, 10, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11, 0, 6,                //
      0, 8, 0, 9, 0, 10, 0, 11, 7, 6, 8, 7, 9, 8, 10, 9, 11, 10, 6, 11;
  return std::make_shared<const mesh::DrawnShape>(mesh::ShapeOfMesh(surface).value());
}

// Boxes on a grid of 0.1 m that do not intersect, in a random hierarchy; some alike, some fixed.
inline Assembly RandomAssembly(unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [&](int from, int to) {
    return from + static_cast<int>(random() % static_cast<unsigned>(to - from + 1));
  };
  Assembly assembly;
  assembly.name = "random";
  assembly.groups = {{"root", -1}};
  for (int i = 1; i < 5; ++i) {
    assembly.groups.push_back({"group " + std::to_string(i), pick(0, i - 1)});
  }
  for (int tries = 0; tries < 60; ++tries) {
    const Eigen::Vector3d minimum = 0.1 * Eigen::Vector3d(pick(0, 7), pick(0, 7), pick(0, 7));
    const Eigen::Vector3d size = 0.1 * Eigen::Vector3d(pick(1, 3), pick(1, 3), pick(1, 2));
    bool free = true;
    for (const AssemblyPart& part : assembly.parts) {
      const Eigen::Vector3d overlap =
          part.box.maximum.cwiseMin(minimum + size) - part.box.minimum.cwiseMax(minimum);
      free &= overlap.minCoeff() < 1e-9;
    }
    if (!free) continue;
    const std::string name = "part " + std::to_string(assembly.parts.size());
    const int group = pick(0, 4);
    assembly.parts.push_back(pick(0, 4) == 0 ? FixedPart(name, minimum, minimum + size, group)
                                             : ResizablePart(name, minimum, minimum + size, group));
  }
  return assembly;
}

// Pairs of boxes that share a piece of face, an edge or more.
template <typename Elements>
std::vector<std::pair<int, int>> TouchingPairs(const Elements& elements) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t a = 0; a < elements.size(); ++a) {
    for (std::size_t b = a + 1; b < elements.size(); ++b) {
      const Eigen::Vector3d overlap = elements[a].box.maximum.cwiseMin(elements[b].box.maximum) -
                                      elements[a].box.minimum.cwiseMax(elements[b].box.minimum);
      if (overlap.minCoeff() >= -1e-9) pairs.push_back({static_cast<int>(a), static_cast<int>(b)});
    }
  }
  return pairs;
}

}  // namespace mortise::parametric
