#include "common/mesh/shape_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace mortise::mesh {
namespace {

constexpr double kAlong = 1e-9;  // rad, by which a triangle along an axis may lean

// The levels along one axis.
class LevelSearch {
 public:
  LevelSearch(const DrawnShape& shape, int axis)
      : shape_(shape), axis_(axis), same_(kSameLevel / shape.size[axis]) {}

  std::vector<ShapeLevel> Find() {
    for (Eigen::Index t = 0; t < shape_.triangles.cols(); ++t) LookAt(t);
    LookAtVertices();
    return Distinct();
  }

 private:
  // How often and how largely the surface turns back at a height.
  struct Turn {
    double fraction = 0;
    double area = 0;  // of flat faces, as a share of the box's section
  };

  double Height(int vertex) const { return shape_.fractions(axis_, vertex); }
  // -1, 0 or 1: a vertex below, level with or above a height.
  int Side(int vertex, double height) const {
    const double above = Height(vertex) - height;
    return std::abs(above) <= same_ ? 0 : above > 0 ? 1 : -1;
  }

  void LookAt(Eigen::Index t) {
    const std::array<int, 3> corners = {shape_.triangles(0, t), shape_.triangles(1, t),
                                        shape_.triangles(2, t)};
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = corners[k], to = corners[(k + 1) % 3], opposite = corners[(k + 2) % 3];
      for (const int other : {to, opposite}) NoteNeighbour(from, Side(other, Height(from)));
      if (Side(to, Height(from)) == 0) LookAtEdge(std::minmax(from, to), opposite);
    }
    const double height = Height(corners[0]);
    if (Side(corners[1], height) == 0 && Side(corners[2], height) == 0) {
      turns_.push_back({height, SectionOf(shape_, t, axis_)});
    }
  }

  // Of the two triangles at a level edge: whether both go the same way from it.
  void LookAtEdge(std::pair<int, int> edge, int opposite) {
    const int side = Side(opposite, Height(edge.first));
    const auto [found, is_new] = edges_.emplace(edge, side);
    if (!is_new && side != 0 && found->second == side) turns_.push_back({Height(edge.first), 0});
  }

  void NoteNeighbour(int vertex, int side) {
    const auto [found, is_new] = peaks_.emplace(vertex, side);
    if (!is_new && found->second != side) found->second = 0;
  }

  // Single vertices that all their neighbours lie below, or above.
  void LookAtVertices() {
    for (const auto& [vertex, side] : peaks_) {
      if (side != 0) turns_.push_back({Height(vertex), 0});
    }
  }

  std::vector<ShapeLevel> Distinct() {
    std::stable_sort(turns_.begin(), turns_.end(),
                     [](const Turn& a, const Turn& b) { return a.fraction < b.fraction; });
    std::vector<Turn> distinct;
    for (const Turn& turn : turns_) {
      if (0.5 - std::abs(turn.fraction) <= same_) continue;
      if (distinct.empty() || turn.fraction - distinct.back().fraction > same_) {
        distinct.push_back(turn);
      } else {
        distinct.back().area += turn.area;
      }
    }
    std::stable_sort(distinct.begin(), distinct.end(),
                     [](const Turn& a, const Turn& b) { return a.area > b.area; });
    if (distinct.size() > kMostLevels) distinct.resize(kMostLevels);
    std::sort(distinct.begin(), distinct.end(),
              [](const Turn& a, const Turn& b) { return a.fraction < b.fraction; });
    std::vector<ShapeLevel> levels;
    for (const Turn& turn : distinct) levels.push_back({axis_, turn.fraction});
    MarkDividing(levels);
    return levels;
  }

  // Whether a triangle leans against the axis by no more than rounding.
  bool RunsAlong(Eigen::Index t, double reach) const {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return shape_.size.cwiseProduct(shape_.fractions.col(shape_.triangles(k, t)));
    };
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const double lean = std::abs(normal[axis_]);
    return lean <= kAlong * normal.norm() || lean * reach <= kSameLevel * normal.norm();
  }

  // `levels` in order. Of all triangles that do not run along the axis, counts which levels they
  // reach across: one more from the first of them on, one less after the last.
  void MarkDividing(std::vector<ShapeLevel>& levels) const {
    std::vector<int> more(levels.size() + 1, 0);
    const auto first_above = [&](double fraction) {
      return std::lower_bound(
                 levels.begin(), levels.end(), fraction,
                 [](const ShapeLevel& level, double sought) { return level.fraction < sought; }) -
             levels.begin();
    };
    for (Eigen::Index t = 0; t < shape_.triangles.cols(); ++t) {
      const auto [low, high] =
          std::minmax({Height(shape_.triangles(0, t)), Height(shape_.triangles(1, t)),
                       Height(shape_.triangles(2, t))});
      const auto from = first_above(low + same_), to = first_above(high - same_);
      if (from >= to || RunsAlong(t, (high - low) * shape_.size[axis_])) continue;
      ++more[static_cast<std::size_t>(from)];
      --more[static_cast<std::size_t>(to)];
    }
    int across = 0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      across += more[i];
      levels[i].divides = across == 0;
    }
  }

  const DrawnShape& shape_;
  const int axis_;
  const double same_;                         // as a fraction
  std::map<std::pair<int, int>, int> edges_;  // on which side the first triangle goes
  std::map<int, int> peaks_;                  // the side of all neighbours; 0 if they differ
  std::vector<Turn> turns_;
};

}  // namespace

std::vector<ShapeLevel> LevelsOf(const DrawnShape& shape) {
  std::vector<ShapeLevel> levels;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<ShapeLevel> along = LevelSearch(shape, axis).Find();
    levels.insert(levels.end(), along.begin(), along.end());
  }
  return levels;
}

}  // namespace mortise::mesh
