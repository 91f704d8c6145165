// Surfaces like those that people search with: boards joined to furniture.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "common/mesh/joined_surface.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// A box between two corners, two triangles a side.
inline mesh::SurfaceMesh Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  mesh::SurfaceMesh box;
  box.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) {
    box.vertices.col(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
        (i & 4 ? high : low).z();
  }
  box.triangles.resize(3, 12);
  box.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,               //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return box;
}

using mesh::Joined;

// A chair, q = (width, depth, height of the seat, height of the back), m: its vertices are linear
// in q, and a back on one side tells its quarter turns apart.
inline mesh::SurfaceMesh Chair(const Eigen::Vector4d& q) {
  const double x = q[0], y = q[1], seat = q[2], back = q[2] + q[3];
  constexpr double kLeg = 0.05, kBoard = 0.03;
  return Joined({Box({0, 0, 0}, {kLeg, kLeg, seat}), Box({x - kLeg, 0, 0}, {x, kLeg, seat}),
                 Box({0, y - kLeg, 0}, {kLeg, y, seat}), Box({x - kLeg, y - kLeg, 0}, {x, y, seat}),
                 Box({0, 0, seat}, {x, y, seat + kBoard}),
                 Box({0, y - kBoard, seat + kBoard}, {x, y, back})});
}

inline mesh::SurfaceMesh Chair() { return Chair({0.45, 0.5, 0.42, 0.4}); }

// Every triangle as four.
inline mesh::SurfaceMesh Split(const mesh::SurfaceMesh& surface) {
  const Eigen::Index count = surface.triangles.cols();
  mesh::SurfaceMesh split{Eigen::Matrix3Xd(3, 6 * count), Eigen::Matrix3Xi(3, 4 * count)};
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Matrix3d corners = surface.vertices(Eigen::all, surface.triangles.col(t));
    split.vertices.middleCols(6 * t, 3) = corners;
    for (int k = 0; k < 3; ++k) {
      split.vertices.col(6 * t + 3 + k) = (corners.col(k) + corners.col((k + 1) % 3)) / 2;
    }
    Eigen::Matrix<int, 3, 4> four;
    four << 0, 3, 5, 3,  //
        3, 1, 4, 4,      //
        5, 4, 2, 5;
    split.triangles.middleCols(4 * t, 4) = four.array() + static_cast<int>(6 * t);
  }
  return split;
}

// The surface after quarter turns about z, counter-clockwise seen from above.
inline mesh::SurfaceMesh QuarterTurned(mesh::SurfaceMesh surface, int turns) {
  for (int turn = 0; turn < turns; ++turn) {
    const Eigen::RowVectorXd x = surface.vertices.row(0);
    surface.vertices.row(0) = -surface.vertices.row(1);
    surface.vertices.row(1) = x;
  }
  return surface;
}

}  // namespace mortise::retrieval
