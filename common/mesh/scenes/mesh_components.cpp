#include "common/mesh/scenes/mesh_components.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::mesh {
namespace {

constexpr double kMinTolerance = 1e-12;  // relative, so that numbers of cells fit an integer

using Key = std::array<std::int64_t, 3>;

std::uint64_t HashOf(const Key& key) {
  std::uint64_t hash = 0x9e3779b97f4a7c15;
  for (const std::int64_t part : key) {
    hash ^= static_cast<std::uint64_t>(part);
    hash *= 0xff51afd7ed558ccd;
    hash ^= hash >> 32;
  }
  return hash;
}

// Numbers different keys from 0 on. Open addressing: a table of a few bytes for each key.
class KeyNumbers {
 public:
  explicit KeyNumbers(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), -1) {
    keys_.reserve(most);
  }

  // The number of a key, a new one if it has none.
  int Add(const Key& key) {
    int& slot = slots_[SlotOf(key)];
    if (slot < 0) {
      slot = static_cast<int>(keys_.size());
      keys_.push_back(key);
    }
    return slot;
  }

  // The number of a key, or -1.
  int Find(const Key& key) const { return slots_[SlotOf(key)]; }

  const std::vector<Key>& keys() const { return keys_; }

 private:
  std::size_t SlotOf(const Key& key) const {
    std::size_t slot = HashOf(key) & (slots_.size() - 1);
    while (slots_[slot] >= 0 && keys_[static_cast<std::size_t>(slots_[slot])] != key) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slot;
  }

  std::vector<int> slots_;
  std::vector<Key> keys_;
};

// Sets of numbers that are joined in pairs.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int Find(int i) {
    while (At(i) != i) i = At(i) = At(At(i));
    return i;
  }

  // The set is known by its least number.
  void Join(int i, int j) {
    i = Find(i);
    j = Find(j);
    At(std::max(i, j)) = std::min(i, j);
  }

 private:
  int& At(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

// Counts the sets anew, in the order in which `members` meet them; returns how many there are.
int NumberInOrder(Eigen::VectorXi& members) {
  std::vector<int> numbers(
      members.size() == 0 ? 0 : static_cast<std::size_t>(members.maxCoeff()) + 1, -1);
  int count = 0;
  for (int& member : members) {
    int& number = numbers[static_cast<std::size_t>(member)];
    if (number < 0) number = count++;
    member = number;
  }
  return count;
}

// The number of each point's cell of a grid.
Eigen::VectorXi CellsOf(const Eigen::Matrix3Xd& points, double width, KeyNumbers& cells) {
  const Eigen::Vector3d origin = points.rowwise().minCoeff();
  Eigen::VectorXi cell_of(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d place = ((points.col(i) - origin) / width).array().floor();
    cell_of(i) =
        cells.Add({static_cast<std::int64_t>(place.x()), static_cast<std::int64_t>(place.y()),
                   static_cast<std::int64_t>(place.z())});
  }
  return cell_of;
}

// Joins every cell with those of its 26 neighbours that hold points; half of them find it.
void JoinNeighbours(const KeyNumbers& cells, DisjointSets& sets) {
  for (std::size_t c = 0; c < cells.keys().size(); ++c) {
    const auto& [x, y, z] = cells.keys()[c];
    for (int neighbour = 14; neighbour < 27; ++neighbour) {
      const int other =
          cells.Find({x + neighbour % 3 - 1, y + neighbour / 3 % 3 - 1, z + neighbour / 9 - 1});
      if (other >= 0) sets.Join(static_cast<int>(c), other);
    }
  }
}

Eigen::VectorXi WeldEqual(const Eigen::Matrix3Xd& points) {
  KeyNumbers places(static_cast<std::size_t>(points.cols()));
  Eigen::VectorXi place_of(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Key key;
    // Adding 0 makes 0 of -0.
    for (int k = 0; k < 3; ++k) {
      key[static_cast<std::size_t>(k)] = std::bit_cast<std::int64_t>(points(k, i) + 0.0);
    }
    place_of(i) = places.Add(key);
  }
  return place_of;
}

}  // namespace

Eigen::VectorXi WeldPoints(const Eigen::Matrix3Xd& points, double tolerance) {
  if (tolerance <= 0 || points.cols() == 0) return WeldEqual(points);
  KeyNumbers cells(static_cast<std::size_t>(points.cols()));
  Eigen::VectorXi place_of = CellsOf(points, tolerance, cells);
  DisjointSets sets(cells.keys().size());
  JoinNeighbours(cells, sets);
  for (int& place : place_of) place = sets.Find(place);
  NumberInOrder(place_of);
  return place_of;
}

ConnectedTriangles FindConnected(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles, double relative_tolerance) {
  ConnectedTriangles connected;
  connected.piece.resize(triangles.cols());
  if (triangles.cols() == 0) return connected;
  double tolerance = 0;
  if (relative_tolerance > 0) {
    const double diagonal = (vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff()).norm();
    tolerance = std::max(relative_tolerance, kMinTolerance) * diagonal;
  }
  const Eigen::VectorXi places = WeldPoints(vertices, tolerance);
  DisjointSets sets(static_cast<std::size_t>(places.maxCoeff()) + 1);
  for (const auto& corners : triangles.colwise()) {
    sets.Join(places(corners(0)), places(corners(1)));
    sets.Join(places(corners(0)), places(corners(2)));
  }
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    connected.piece(t) = sets.Find(places(triangles(0, t)));
  }
  connected.count = NumberInOrder(connected.piece);
  return connected;
}

SceneComponent PieceOf(const SceneComponent& component, const std::vector<int>& triangles) {
  std::vector<int> used;
  used.reserve(3 * triangles.size());
  for (const int triangle : triangles) {
    for (const int vertex : component.triangles.col(triangle)) used.push_back(vertex);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  SceneComponent piece;
  piece.vertices = component.vertices(Eigen::all, used);
  piece.triangles = component.triangles(Eigen::all, triangles);
  for (int& vertex : piece.triangles.reshaped()) {
    vertex = static_cast<int>(std::lower_bound(used.begin(), used.end(), vertex) - used.begin());
  }
  return piece;
}

std::vector<SceneComponent> Separated(const SceneComponent& component, double relative_tolerance) {
  const ConnectedTriangles connected =
      FindConnected(component.vertices, component.triangles, relative_tolerance);
  std::vector<std::vector<int>> triangles(static_cast<std::size_t>(connected.count));
  for (Eigen::Index t = 0; t < connected.piece.size(); ++t) {
    triangles[static_cast<std::size_t>(connected.piece(t))].push_back(static_cast<int>(t));
  }
  std::vector<SceneComponent> pieces;
  pieces.reserve(triangles.size());
  for (const std::vector<int>& of_piece : triangles) {
    pieces.push_back(PieceOf(component, of_piece));
    std::string& name = pieces.back().name;
    name = component.name;
    if (triangles.size() > 1) {
      absl::StrAppend(&name, name.empty() ? "" : " ", pieces.size());
    }
  }
  return pieces;
}

}  // namespace mortise::mesh
