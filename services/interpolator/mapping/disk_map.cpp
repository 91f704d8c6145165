#include "services/interpolator/mapping/disk_map.h"

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/mapping/guarded.h"

namespace mortise::interpolator {
namespace {

using Side = std::pair<int, int>;

absl::Status CheckDisk(const DiskPatch& patch) {
  std::map<Side, int> sides;
  for (Eigen::Index t = 0; t < patch.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = patch.triangles(k, t), to = patch.triangles((k + 1) % 3, t);
      if (++sides[{from, to}] > 1) {
        return InvalidField("patch", absl::StrCat("triangle ", t, " has an edge of another one"));
      }
      if ((patch.vertices.col(from) - patch.vertices.col(to)).norm() == 0) {
        return InvalidField("patch", absl::StrCat("triangle ", t, " has an edge without length"));
      }
    }
  }
  std::set<Side> open;
  for (const auto& [side, count] : sides) {
    if (sides.find({side.second, side.first}) == sides.end()) open.insert(side);
  }
  const std::size_t size = patch.boundary.size();
  for (std::size_t i = 0; i < size; ++i) {
    if (open.erase({patch.boundary[i], patch.boundary[(i + 1) % size]}) == 0) {
      return InvalidField("patch",
                          absl::StrCat("boundary[", i, "] begins no side of the boundary"));
    }
  }
  const auto edges = static_cast<Eigen::Index>((sides.size() + size) / 2);
  if (!open.empty() || patch.vertices.cols() - edges + patch.triangles.cols() != 1) {
    return InvalidField("patch", "it is no disk with this boundary");
  }
  return absl::OkStatus();
}

// Solves for the inner vertices: each the mean of its neighbours, weighted by mean values or
// equally. INTERNAL if the equations cannot be solved.
absl::StatusOr<Eigen::Matrix2Xd> Flatten(const DiskPatch& patch, const Eigen::Matrix2Xd& boundary,
                                         bool has_equal_weights) {
  const Eigen::Index count = patch.vertices.cols();
  Eigen::VectorXi unknown = Eigen::VectorXi::Zero(count);
  Eigen::Matrix2Xd positions = Eigen::Matrix2Xd::Zero(2, count);
  for (std::size_t i = 0; i < patch.boundary.size(); ++i) {
    unknown[patch.boundary[i]] = -1;
    positions.col(patch.boundary[i]) = boundary.col(static_cast<Eigen::Index>(i));
  }
  int unknowns = 0;
  for (Eigen::Index v = 0; v < count; ++v) {
    if (unknown[v] == 0) unknown[v] = unknowns++;
  }
  if (unknowns == 0) return positions;
  Eigen::VectorXd total = Eigen::VectorXd::Zero(unknowns);
  std::vector<std::pair<Side, double>> weights;
  for (Eigen::Index t = 0; t < patch.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int row = unknown[patch.triangles(k, t)];
      if (row < 0) continue;
      const auto corner = [&](int i) -> Eigen::Vector3d {
        return patch.vertices.col(patch.triangles((k + i) % 3, t));
      };
      auto [next, last] = MeanValueWeights(corner(0), corner(1), corner(2));
      if (has_equal_weights) next = last = 1;
      weights.push_back({{row, patch.triangles((k + 1) % 3, t)}, next});
      weights.push_back({{row, patch.triangles((k + 2) % 3, t)}, last});
      total[row] += next + last;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(unknowns, 2);
  for (int row = 0; row < unknowns; ++row) entries.emplace_back(row, row, 1.0);
  for (const auto& [side, weight] : weights) {
    const double share = weight / total[side.first];
    const int column = unknown[side.second];
    if (column >= 0) entries.emplace_back(side.first, column, -share);
    if (column < 0) right.row(side.first) += share * positions.col(side.second).transpose();
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return absl::InternalError("a patch cannot be flattened");
  const Eigen::MatrixX2d solution = solver.solve(right);
  for (Eigen::Index v = 0; v < count; ++v) {
    if (unknown[v] >= 0) positions.col(v) = solution.row(unknown[v]).transpose();
  }
  return positions;
}

double Area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d ab = b - a, ac = c - a;
  return (ab.x() * ac.y() - ab.y() * ac.x()) / 2;
}

bool HasFlipped(const Eigen::Matrix3Xi& triangles, const Eigen::Matrix2Xd& positions) {
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const double area = Area(positions.col(triangles(0, t)), positions.col(triangles(1, t)),
                             positions.col(triangles(2, t)));
    if (!(area > 0)) return true;
  }
  return false;
}

Eigen::Matrix3Xi Neighbours(const Eigen::Matrix3Xi& triangles) {
  std::map<Side, int> owner;
  for (int t = 0; t < static_cast<int>(triangles.cols()); ++t) {
    for (int k = 0; k < 3; ++k) owner[{triangles(k, t), triangles((k + 1) % 3, t)}] = t;
  }
  Eigen::Matrix3Xi neighbours(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto beyond = owner.find({triangles((k + 2) % 3, t), triangles((k + 1) % 3, t)});
      neighbours(k, t) = beyond == owner.end() ? -1 : beyond->second;
    }
  }
  return neighbours;
}

TrianglePlace Clamped(int triangle, const Eigen::Vector3d& barycentric) {
  const Eigen::Vector3d inside = barycentric.cwiseMax(0.0);
  return {triangle, inside / inside.sum()};
}

}  // namespace

std::pair<double, double> MeanValueWeights(const Eigen::Vector3d& at, const Eigen::Vector3d& next,
                                           const Eigen::Vector3d& last) {
  const Eigen::Vector3d to_next = next - at, to_last = last - at;
  const double lengths = to_next.norm() * to_last.norm();
  // tan(α/2) = sin α / (1 + cos α), bounded where rounding would make it infinite.
  const double tangent =
      to_next.cross(to_last).norm() / std::max(lengths + to_next.dot(to_last), 1e-12 * lengths);
  return {tangent / to_next.norm(), tangent / to_last.norm()};
}

DiskMap::DiskMap(Eigen::Matrix3Xi triangles, Eigen::Matrix2Xd positions)
    : triangles_(std::move(triangles)),
      neighbours_(Neighbours(triangles_)),
      positions_(std::move(positions)) {}

absl::StatusOr<DiskMap> DiskMap::Create(const DiskPatch& patch, const Eigen::Matrix2Xd& boundary) {
  return Guarded([&] { return Make(patch, boundary); });
}

// It throws what Eigen does.
absl::StatusOr<DiskMap> DiskMap::Make(const DiskPatch& patch, const Eigen::Matrix2Xd& boundary) {
  MORTISE_RETURN_IF_ERROR(CheckDisk(patch));
  if (boundary.cols() != static_cast<Eigen::Index>(patch.boundary.size())) {
    return InvalidField("boundary", absl::StrCat("it has ", boundary.cols(), " positions for ",
                                                 patch.boundary.size(), " vertices"));
  }
  for (const bool has_equal_weights : {false, true}) {
    absl::StatusOr<Eigen::Matrix2Xd> positions = Flatten(patch, boundary, has_equal_weights);
    if (positions.ok() && !HasFlipped(patch.triangles, *positions)) {
      return DiskMap(patch.triangles, *std::move(positions));
    }
  }
  return absl::InternalError(
      "a patch cannot be flattened: rounding turns over triangles, which are too small for it");
}

Eigen::Vector3d DiskMap::Barycentric(int triangle, const Eigen::Vector2d& point) const {
  const Eigen::Vector2d a = positions_.col(triangles_(0, triangle));
  const Eigen::Vector2d b = positions_.col(triangles_(1, triangle));
  const Eigen::Vector2d c = positions_.col(triangles_(2, triangle));
  return Eigen::Vector3d(Area(point, b, c), Area(a, point, c), Area(a, b, point)) / Area(a, b, c);
}

TrianglePlace DiskMap::Locate(const Eigen::Vector2d& point, int hint) const {
  int triangle = hint;
  for (Eigen::Index step = 0; step < triangles_.cols(); ++step) {
    const Eigen::Vector3d barycentric = Barycentric(triangle, point);
    int corner = 0;
    if (barycentric.minCoeff(&corner) >= 0) return {triangle, barycentric};
    // A walk ends where the region does, or goes in circles where triangles are far from
    // Delaunay's.
    if (neighbours_(corner, triangle) < 0) break;
    triangle = neighbours_(corner, triangle);
  }
  int best = 0;
  Eigen::Vector3d best_barycentric = Barycentric(0, point);
  for (int t = 1; t < static_cast<int>(triangles_.cols()); ++t) {
    const Eigen::Vector3d barycentric = Barycentric(t, point);
    if (barycentric.minCoeff() <= best_barycentric.minCoeff()) continue;
    best = t;
    best_barycentric = barycentric;
  }
  return Clamped(best, best_barycentric);
}

}  // namespace mortise::interpolator
