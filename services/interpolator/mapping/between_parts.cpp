#include "services/interpolator/mapping/between_parts.h"

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <map>
#include <optional>

#include "common/base/errors.h"
#include "services/interpolator/mapping/disk_map.h"
#include "services/interpolator/mapping/guarded.h"
#include "services/interpolator/mapping/nearest_place.h"

namespace mortise::interpolator {
namespace {

using Parts = std::pair<int, int>;

// Vertices that are joined to no known one are where the box of those that are takes them.
void StretchLooseOnes(const PartTriangles& target, std::vector<bool>& is_known,
                      Eigen::Matrix3Xd& positions) {
  std::vector<bool> is_joined = is_known;
  const Eigen::Matrix3Xi& triangles = target.surface.triangles;
  for (bool has_new = true; has_new;) {
    has_new = false;
    for (const auto& corners : triangles.colwise()) {
      int joined = 0;
      for (const int corner : corners) joined += is_joined[static_cast<std::size_t>(corner)];
      if (joined == 0 || joined == 3) continue;
      for (const int corner : corners) is_joined[static_cast<std::size_t>(corner)] = true;
      has_new = true;
    }
  }
  Eigen::AlignedBox3d before, after;
  for (std::size_t v = 0; v < is_known.size(); ++v) {
    if (!is_known[v]) continue;
    before.extend(target.surface.vertices.col(static_cast<Eigen::Index>(v)));
    after.extend(positions.col(static_cast<Eigen::Index>(v)));
  }
  const Eigen::Array3d stretch = after.sizes().array() / before.sizes().array().max(1e-300);
  for (const int corner : triangles.reshaped()) {
    if (is_joined[static_cast<std::size_t>(corner)]) continue;
    const Eigen::Array3d off = target.surface.vertices.col(corner) - before.min();
    positions.col(corner) = after.min() + (off * stretch).matrix();
    is_known[static_cast<std::size_t>(corner)] = true;
  }
}

// Solves for the unknown vertices: each the mean of its neighbours, weighted by mean values.
absl::Status Relax(const PartTriangles& target, const std::vector<int>& unknown, int count,
                   Eigen::Matrix3Xd& positions) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(count, 3);
  for (const auto& corners : target.surface.triangles.colwise()) {
    const Eigen::Matrix3d at = target.surface.vertices(Eigen::all, corners);
    for (int k = 0; k < 3; ++k) {
      const int row = unknown[static_cast<std::size_t>(corners[k])];
      if (row < 0) continue;
      const auto weights = MeanValueWeights(at.col(k), at.col((k + 1) % 3), at.col((k + 2) % 3));
      for (const auto& [step, weight] : {std::pair{1, weights.first}, {2, weights.second}}) {
        const int other = corners[(k + step) % 3];
        const int column = unknown[static_cast<std::size_t>(other)];
        entries.emplace_back(row, row, weight);
        if (column >= 0) entries.emplace_back(row, column, -weight);
        if (column < 0) right.row(row) += weight * positions.col(other).transpose();
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixX3d solution = solver.solve(right);
  if (solver.info() != Eigen::Success || !solution.allFinite()) {
    return absl::InternalError("triangles between parts cannot follow the outside");
  }
  for (std::size_t v = 0; v < unknown.size(); ++v) {
    if (unknown[v] < 0) continue;
    positions.col(static_cast<Eigen::Index>(v)) = solution.row(unknown[v]).transpose();
  }
  return absl::OkStatus();
}

// The source's triangles to search for places, made when they are first asked for.
class Places {
 public:
  Places(const PartTriangles& source, const mesh::SurfaceMesh& all) : source_(source), all_(all) {}

  // Returns the place that is nearest between these parts, or, where there is nothing between them,
  // on anything.
  absl::StatusOr<NodePlace> Find(const Parts& parts, const Eigen::Vector3d& point,
                                 bool& is_between) {
    Searched& of = searched_[parts];
    if (!of.nearest) MORTISE_RETURN_IF_ERROR(Prepare(parts, of));
    is_between = of.is_between;
    MORTISE_ASSIGN_OR_RETURN(const TrianglePlace place, of.nearest->Find(point));
    return NodePlace{of.triangles.col(place.triangle), place.barycentric};
  }

 private:
  struct Searched {
    Eigen::Matrix3Xi triangles;
    bool is_between = true;
    std::optional<NearestPlaces> nearest;
  };

  absl::Status Prepare(const Parts& parts, Searched& of) const {
    std::vector<int> chosen;
    for (std::size_t t = 0; t < source_.parts.size(); ++t) {
      if (source_.parts[t] == parts) chosen.push_back(static_cast<int>(t));
    }
    of.is_between = !chosen.empty();
    of.triangles =
        chosen.empty() ? all_.triangles : source_.surface.triangles(Eigen::all, chosen).eval();
    MORTISE_ASSIGN_OR_RETURN(of.nearest, NearestPlaces::Create({all_.vertices, of.triangles}));
    return absl::OkStatus();
  }

  const PartTriangles& source_;
  const mesh::SurfaceMesh& all_;
  std::map<Parts, Searched> searched_;
};

}  // namespace

absl::StatusOr<int> FollowBetweenParts(const PartTriangles& source, const PartTriangles& target,
                                       const mesh::SurfaceMesh& all,
                                       const std::vector<bool>& is_known,
                                       Eigen::Matrix3Xd& positions,
                                       std::vector<NodePlace>& places) {
  std::vector<bool> is_placed = is_known;
  StretchLooseOnes(target, is_placed, positions);
  std::vector<int> unknown(is_known.size(), -1);
  int count = 0;
  for (const int corner : target.surface.triangles.reshaped()) {
    const auto v = static_cast<std::size_t>(corner);
    if (!is_placed[v] && unknown[v] < 0) unknown[v] = count++;
  }
  if (count > 0) {
    MORTISE_RETURN_IF_ERROR(Guarded([&] { return Relax(target, unknown, count, positions); }));
  }
  std::map<int, Parts> parts_of;
  for (Eigen::Index i = 0; i < target.surface.triangles.size(); ++i) {
    const int corner = target.surface.triangles(i % 3, i / 3);
    if (is_known[static_cast<std::size_t>(corner)]) continue;
    parts_of.try_emplace(corner, target.parts[static_cast<std::size_t>(i / 3)]);
  }
  Places nearest(source, all);
  for (const auto& [corner, parts] : parts_of) {
    bool is_between = false;
    NodePlace& place = places[static_cast<std::size_t>(corner)];
    MORTISE_ASSIGN_OR_RETURN(place, nearest.Find(parts, positions.col(corner), is_between));
    if (is_between) positions.col(corner) = all.vertices(Eigen::all, place.nodes) * place.shares;
  }
  return static_cast<int>(parts_of.size());
}

}  // namespace mortise::interpolator
