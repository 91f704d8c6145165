// Makes of surfaces what a scanner sees of them: many small triangles, with noise and holes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "common/base/random.h"
#include "common/mesh/point_merger.h"
#include "common/mesh/surface_mesh.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval::testing {

inline double DiagonalOf(const mesh::SurfaceMesh& surface) {
  return (surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff()).norm();
}

// Seven boards between two sides, each a box of twelve triangles that touches others.
inline mesh::SurfaceMesh Shelf(double length, double thickness) {
  constexpr double kDepth = 0.3, kHeight = 1.8;
  constexpr int kBoards = 7;
  std::vector<mesh::SurfaceMesh> boxes = {
      Box({0, 0, 0}, {thickness, kDepth, kHeight}),
      Box({length - thickness, 0, 0}, {length, kDepth, kHeight})};
  for (int i = 0; i < kBoards; ++i) {
    const double bottom = i * (kHeight - thickness) / (kBoards - 1);
    boxes.push_back(Box({thickness, 0, bottom}, {length - thickness, kDepth, bottom + thickness}));
  }
  mesh::SurfaceMesh shelf{Eigen::Matrix3Xd(3, 8 * boxes.size()),
                          Eigen::Matrix3Xi(3, 12 * boxes.size())};
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(i);
    shelf.vertices.middleCols(8 * first, 8) = boxes[i].vertices;
    shelf.triangles.middleCols(12 * first, 12) = boxes[i].triangles.array() + 8 * int(i);
  }
  return shelf;
}

// The same surface with edges no longer than `longest`, halved where they are; vertices at one
// place are one.
inline mesh::SurfaceMesh Refined(const mesh::SurfaceMesh& surface, double longest) {
  using Triangle = std::array<Eigen::Vector3d, 3>;
  mesh::PointMerger points(1e-7 * DiagonalOf(surface));
  std::vector<Eigen::Vector3i> triangles;
  std::vector<Triangle> left;
  for (const auto& corners : surface.triangles.colwise()) {
    left.push_back({surface.vertices.col(corners[0]), surface.vertices.col(corners[1]),
                    surface.vertices.col(corners[2])});
    while (!left.empty()) {
      Triangle next = left.back();
      left.pop_back();
      for (int turn = 0; turn < 3; ++turn) {
        const double first = (next[1] - next[0]).norm();
        if (first >= (next[2] - next[1]).norm() && first >= (next[0] - next[2]).norm()) break;
        next = {next[1], next[2], next[0]};
      }
      if ((next[1] - next[0]).norm() > longest) {
        const Eigen::Vector3d middle = 0.5 * (next[0] + next[1]);
        left.push_back({next[0], middle, next[2]});
        left.push_back({middle, next[1], next[2]});
        continue;
      }
      triangles.emplace_back(points.IndexOf(next[0]), points.IndexOf(next[1]),
                             points.IndexOf(next[2]));
    }
  }
  mesh::SurfaceMesh refined{points.Points(), Eigen::Matrix3Xi(3, Eigen::Index(triangles.size()))};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    refined.triangles.col(Eigen::Index(t)) = triangles[t];
  }
  return refined;
}

// Normal noise of this standard deviation in each coordinate of each vertex.
inline void AddNoise(mesh::SurfaceMesh& surface, double deviation, Random& random) {
  for (double& coordinate : surface.vertices.reshaped()) coordinate += deviation * random.Normal();
}

// Without a part of the triangles, those nearest to `holes` places on it.
inline void CutHoles(mesh::SurfaceMesh& surface, double part, int holes, Random& random) {
  const Eigen::Index count = surface.triangles.cols();
  Eigen::Matrix3Xd middles(3, count);
  for (Eigen::Index t = 0; t < count; ++t) {
    middles.col(t) = surface.vertices(Eigen::all, surface.triangles.col(t)).rowwise().mean();
  }
  std::vector<bool> gone(static_cast<std::size_t>(count), false);
  const auto of_hole = static_cast<Eigen::Index>(part * double(count) / holes);
  for (int hole = 0; hole < holes; ++hole) {
    const Eigen::Vector3d place = middles.col(Eigen::Index(random.Index(std::size_t(count))));
    std::vector<std::pair<double, Eigen::Index>> order;
    for (Eigen::Index t = 0; t < count; ++t) {
      if (!gone[std::size_t(t)]) order.emplace_back((middles.col(t) - place).norm(), t);
    }
    const auto end =
        order.begin() + std::min<std::ptrdiff_t>(of_hole, std::ptrdiff_t(order.size()));
    std::partial_sort(order.begin(), end, order.end());
    for (auto each = order.begin(); each != end; ++each) gone[std::size_t(each->second)] = true;
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < count; ++t) {
    if (!gone[std::size_t(t)]) kept.push_back(t);
  }
  surface.triangles = Eigen::Matrix3Xi(surface.triangles(Eigen::all, kept));
}

// Turned about the vertical and moved.
inline mesh::SurfaceMesh Placed(mesh::SurfaceMesh surface, double turn,
                                const Eigen::Vector3d& offset) {
  const Eigen::AngleAxisd rotation(turn, Eigen::Vector3d::UnitZ());
  surface.vertices = (rotation.toRotationMatrix() * surface.vertices).colwise() + offset;
  return surface;
}

}  // namespace mortise::retrieval::testing
