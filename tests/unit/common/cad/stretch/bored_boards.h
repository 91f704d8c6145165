// Boards with bores and grooves, and how to stretch them in pieces.
#pragma once

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <cmath>
#include <random>
#include <vector>

#include "common/cad/stretch/solid_shape.h"
#include "common/mesh/shapes/shape_levels.h"
#include "common/mesh/shared_edges.h"
#include "tests/unit/common/cad/surface/fused_parts.h"

namespace mortise::cad {

// A cylinder to be cut away: along an axis, through a point of the axis.
struct Bore {
  int axis = 2;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // m, from the middle of the board
  double radius = 0;
  double length = 10;
};

inline TopoDS_Shape ToolOf(const Bore& bore) {
  Eigen::Vector3d from = bore.middle;
  from[bore.axis] -= bore.length / 2;
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(bore.axis);
  return BRepPrimAPI_MakeCylinder(
             gp_Ax2(gp_Pnt(from.x(), from.y(), from.z()), gp_Dir(along.x(), along.y(), along.z())),
             bore.radius, bore.length)
      .Solid();
}

inline TopoDS_Shape Board(const Eigen::Vector3d& size) {
  return BoxAt(-size.x() / 2, -size.y() / 2, -size.z() / 2, size.x(), size.y(), size.z());
}

inline TopoDS_Shape Bored(const Eigen::Vector3d& size, const std::vector<Bore>& bores) {
  TopoDS_Shape board = Board(size);
  for (const Bore& bore : bores) board = BRepAlgoAPI_Cut(board, ToolOf(bore)).Shape();
  return board;
}

// `size`: of the solid's box, in the middle of which is the origin.
inline mesh::DrawnShape Drawn(const TopoDS_Shape& solid, const Eigen::Vector3d& size) {
  auto shape =
      ShapeOfSolid(Named(solid, "solid"), Eigen::Matrix3d::Identity(), -size / 2, size / 2);
  EXPECT_TRUE(shape.ok()) << shape.status();
  return shape.ok() ? *std::move(shape) : mesh::DrawnShape();
}

inline std::vector<mesh::ShapeLevel> DividingLevels(const mesh::DrawnShape& shape) {
  std::vector<mesh::ShapeLevel> levels = mesh::LevelsOf(shape);
  std::erase_if(levels, [](const mesh::ShapeLevel& level) { return !level.divides; });
  return levels;
}

// Each piece between levels becomes a third to three times as long.
inline mesh::BoxStretch RandomStretch(const mesh::DrawnShape& shape,
                                      const std::vector<mesh::ShapeLevel>& levels,
                                      std::mt19937_64& random) {
  std::uniform_real_distribution<double> exponent(-1, 1);
  mesh::BoxStretch stretch(shape.size);
  for (const mesh::ShapeLevel& level : levels) {
    stretch.levels[static_cast<std::size_t>(level.axis)].push_back({level.fraction, 0});
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<mesh::LevelPlace>& places = stretch.levels[static_cast<std::size_t>(axis)];
    double below = -0.5, length = 0;
    for (std::size_t i = 0; i <= places.size(); ++i) {
      const double above = i < places.size() ? places[i].fraction : 0.5;
      length += (above - below) * shape.size[axis] * std::pow(3, exponent(random));
      below = above;
      if (i < places.size()) places[i].place = length;
    }
    for (mesh::LevelPlace& place : places) place.place -= length / 2;
    stretch.size[axis] = length;
  }
  return stretch;
}

// Triangles whose normals point elsewhere than they did: folds.
inline int CountFolds(const mesh::DrawnShape& shape, const mesh::BoxStretch& stretch) {
  const Eigen::Matrix3Xd before =
      mesh::TriangleNormals(mesh::SurfaceIn(shape, shape.size).vertices, shape.triangles);
  const Eigen::Matrix3Xd after =
      mesh::TriangleNormals(mesh::SurfaceIn(shape, stretch).vertices, shape.triangles);
  int folds = 0;
  for (Eigen::Index t = 0; t < before.cols(); ++t) {
    for (int axis = 0; axis < 3; ++axis) {
      folds += before(axis, t) * after(axis, t) < -1e-6;
    }
  }
  return folds;
}

inline const Eigen::Vector3d kBlock(0.1, 0.06, 0.04);
// Across each other without meeting: one upright, one along.
inline const std::vector<Bore> kTwoBores = {{2, {-0.02, -0.015, 0}, 0.0093},
                                            {0, {0, 0.015, 0}, 0.0061}};

}  // namespace mortise::cad
