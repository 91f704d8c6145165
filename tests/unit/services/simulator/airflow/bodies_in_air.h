// Closed surfaces that air flows around in tests.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "common/mesh/surface_mesh.h"

namespace mortise::simulator {

// A brick of these edges (m) about the origin.
inline mesh::SurfaceMesh Brick(const Eigen::Vector3d& edges) {
  mesh::SurfaceMesh brick;
  brick.vertices.resize(3, 8);
  for (int v = 0; v < 8; ++v) {
    const Eigen::Vector3d corner(v & 1, (v >> 1) & 1, (v >> 2) & 1);
    brick.vertices.col(v) = edges.cwiseProduct(corner - Eigen::Vector3d::Constant(0.5));
  }
  brick.triangles.resize(3, 12);
  brick.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                 //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return brick;
}

// A ball of this radius (m) about the origin, of as many rings of faces as it is divided.
inline mesh::SurfaceMesh Ball(double radius, int rings = 24) {
  const int around = 2 * rings;
  mesh::SurfaceMesh ball;
  ball.vertices.resize(3, (rings - 1) * around + 2);
  const auto vertex = [&](int ring, int step) {
    if (ring == 0) return 0;
    if (ring == rings) return (rings - 1) * around + 1;
    return 1 + (ring - 1) * around + step % around;
  };
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (int step = 0; step < around; ++step) {
      const double turn = 2 * std::numbers::pi * step / around;
      ball.vertices.col(vertex(ring, step)) =
          radius * Eigen::Vector3d(std::sin(polar) * std::cos(turn),
                                   std::sin(polar) * std::sin(turn), std::cos(polar));
    }
  }
  ball.triangles.resize(3, 2 * around * (rings - 1));
  Eigen::Index count = 0;
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < around; ++step) {
      const int a = vertex(ring, step), b = vertex(ring + 1, step);
      const int c = vertex(ring + 1, step + 1), d = vertex(ring, step + 1);
      if (ring > 0) ball.triangles.col(count++) << a, b, d;
      if (ring < rings - 1) ball.triangles.col(count++) << d, b, c;
    }
  }
  return ball;
}

}  // namespace mortise::simulator
