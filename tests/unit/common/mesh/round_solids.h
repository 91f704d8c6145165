// Closed surfaces whose shadows, moments and water lines are known.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// A surface of `rings` × `sides` points, closed in both directions; `at` gives them in radians.
template <typename At>
SurfaceMesh ClosedGrid(int rings, int sides, const At& at) {
  SurfaceMesh surface;
  surface.vertices.resize(3, rings * sides);
  surface.triangles.resize(3, 2 * rings * sides);
  const auto index = [&](int i, int k) { return (i % rings) * sides + k % sides; };
  const double turn = 2 * std::numbers::pi;
  Eigen::Index next = 0;
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < sides; ++k) {
      surface.vertices.col(index(i, k)) = at(turn * i / rings, turn * k / sides);
      surface.triangles.col(next++) << index(i, k), index(i + 1, k), index(i + 1, k + 1);
      surface.triangles.col(next++) << index(i, k), index(i + 1, k + 1), index(i, k + 1);
    }
  }
  return surface;
}

// About z; a hole of radius `around` − `across` in the middle.
inline SurfaceMesh Torus(double around, double across, int divisions) {
  return ClosedGrid(divisions, divisions, [&](double u, double v) {
    const double radius = around + across * std::cos(v);
    return Eigen::Vector3d(radius * std::cos(u), radius * std::sin(u), across * std::sin(v));
  });
}

// A cone over a regular polygon: `levels` are (radius, z) from the lowest to the highest, the first
// and the last closed by a point on the axis.
inline SurfaceMesh Turned(const std::vector<std::pair<double, double>>& levels, int sides) {
  const int count = static_cast<int>(levels.size());
  SurfaceMesh surface;
  surface.vertices.resize(3, count * sides + 2);
  const int bottom = count * sides, top = bottom + 1;
  surface.vertices.col(bottom) << 0, 0, levels.front().second;
  surface.vertices.col(top) << 0, 0, levels.back().second;
  std::vector<Eigen::Vector3i> triangles;
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      const auto& [radius, z] = levels[static_cast<std::size_t>(i)];
      surface.vertices.col(i * sides + k) << radius * std::cos(angle), radius * std::sin(angle), z;
      const int next = (k + 1) % sides;
      if (i == 0) triangles.emplace_back(bottom, next, k);
      if (i + 1 == count) {
        triangles.emplace_back(top, i * sides + k, i * sides + next);
        continue;
      }
      triangles.emplace_back(i * sides + k, i * sides + next, (i + 1) * sides + next);
      triangles.emplace_back(i * sides + k, (i + 1) * sides + next, (i + 1) * sides + k);
    }
  }
  surface.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    surface.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return surface;
}

inline SurfaceMesh Cylinder(double radius, double height, int sides) {
  return Turned({{radius, 0}, {radius, height}}, sides);
}

// Poles are on z; they end in small flat caps.
inline SurfaceMesh Sphere(double radius, int divisions) {
  std::vector<std::pair<double, double>> levels;
  for (int i = 0; i <= divisions; ++i) {
    const double angle = std::numbers::pi * (i + 0.02) / (divisions + 0.04);
    levels.emplace_back(radius * std::sin(angle), -radius * std::cos(angle));
  }
  return Turned(levels, 2 * divisions);
}

inline SurfaceMesh Moved(SurfaceMesh surface, const Eigen::Vector3d& by) {
  surface.vertices.colwise() += by;
  return surface;
}

inline SurfaceMesh Rotated(SurfaceMesh surface, const Eigen::Matrix3d& rotation) {
  surface.vertices = (rotation * surface.vertices).eval();
  return surface;
}

}  // namespace mortise::mesh
