#include "common/mesh/shapes/shape_levels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/mesh/shapes/countersinks.h"
#include "common/mesh/shapes/round_faces.h"
#include "common/mesh/shared_edges.h"

namespace mortise::mesh {
namespace {

constexpr double kAlong = 1e-9;  // rad, by which a triangle along an axis may lean

// The levels along one axis.
class LevelSearch {
 public:
  LevelSearch(const DrawnShape& shape, const std::vector<SharedEdge>& edges,
              const std::vector<RoundFace>& round_faces,
              const std::vector<Countersink>& countersinks, int axis)
      : shape_(shape), axis_(axis), same_(kSameLevel / shape.size[axis]) {
    for (const RoundFace& face : round_faces) LookAt(face);
    for (const Countersink& countersink : countersinks) LookAt(countersink);
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) LookAt(t);
    for (const SharedEdge& edge : edges) LookAt(edge);
    LookAtVertices();
  }

  std::vector<ShapeLevel> Found(const std::vector<SharedEdge>& edges) {
    std::vector<ShapeLevel> levels = Distinct();
    MarkDividing(edges, levels);
    return levels;
  }

 private:
  // How often and how largely the surface turns back at a height.
  struct Turn {
    double fraction = 0;
    double area = 0;  // of flat faces, as a share of the box's section
  };
  // What lies beside a vertex, and whether that is a round face that goes on to where it reaches
  // furthest: there its level is, not at the vertex.
  struct Place {
    bool is_used = false;
    int side = 0;  // of all neighbours; 0 if they differ
    bool is_round = false;
  };

  double Height(int vertex) const { return shape_.fractions(axis_, vertex); }
  Place& At(int vertex) { return places_[static_cast<std::size_t>(vertex)]; }

  // -1, 0 or 1: a vertex below, level with or above a height.
  int Side(int vertex, double height) const {
    const double above = Height(vertex) - height;
    return std::abs(above) <= same_ ? 0 : above > 0 ? 1 : -1;
  }

  // Where a round face reaches furthest. Its triangles stay inside, by less than a chord's height.
  void LookAt(const RoundFace& face) {
    if (face.axis == axis_) {
      for (const int t : face.triangles) is_along_[static_cast<std::size_t>(t)] = true;
    }
    const double missed = face.radius * (1 - std::cos(face.widest_arc)) + kSameLevel;
    for (std::size_t end = 0; end < 2; ++end) {
      if (!face.reaches[static_cast<std::size_t>(axis_)][end]) continue;
      const double sign = end == 0 ? -1 : 1;
      const double furthest = face.middle[axis_] + sign * face.radius;
      if (shape_.size[axis_] / 2 - std::abs(furthest) > kOnPlane) {
        turns_.push_back({furthest / shape_.size[axis_], 0});
      }
      for (const int t : face.triangles) {
        is_round_[static_cast<std::size_t>(t)] = true;
        for (int k = 0; k < 3; ++k) {
          const int vertex = shape_.triangles(k, t);
          const double inside = sign * (furthest - Height(vertex) * shape_.size[axis_]);
          if (inside <= missed) At(vertex).is_round = true;
        }
      }
    }
  }

  // What is flat around it goes straight on where the circle reaches furthest, and the bore below.
  void LookAt(const Countersink& countersink) {
    const double reach = countersink.axis == axis_ ? countersink.depth / 2 : countersink.radius;
    for (const double side : {-1.0, 1.0}) {
      const double end = countersink.middle[axis_] + side * reach;
      if (shape_.size[axis_] / 2 - std::abs(end) > kOnPlane) {
        turns_.push_back({end / shape_.size[axis_], 0});
      }
    }
  }

  void LookAt(Eigen::Index t) {
    const std::array<int, 3> corners = {shape_.triangles(0, t), shape_.triangles(1, t),
                                        shape_.triangles(2, t)};
    bool is_round = is_round_[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = corners[k];
      for (std::size_t other = 1; other < 3; ++other) {
        NoteNeighbour(from, Side(corners[(k + other) % 3], Height(from)));
      }
      is_round = is_round && At(from).is_round;
    }
    const double height = Height(corners[0]);
    if (!is_round && Side(corners[1], height) == 0 && Side(corners[2], height) == 0) {
      turns_.push_back({height, SectionOf(shape_, t, axis_)});
    }
  }

  // Of the two triangles at a level edge: whether both go the same way from it.
  void LookAt(const SharedEdge& edge) {
    const double height = Height(edge.low);
    if (Side(edge.high, height) != 0) return;
    const auto side_of = [&](int t) {
      const Eigen::Vector3i corners = shape_.triangles.col(t);
      return Side(corners.sum() - edge.low - edge.high, height);
    };
    const int side = side_of(edge.first);
    if (side == 0 || side != side_of(edge.second)) return;
    if (!At(edge.low).is_round || !At(edge.high).is_round) turns_.push_back({height, 0});
  }

  void NoteNeighbour(int vertex, int side) {
    Place& place = At(vertex);
    if (!place.is_used) {
      place.is_used = true;
      place.side = side;
    } else if (place.side != side) {
      place.side = 0;
    }
  }

  // Single vertices that all their neighbours lie below, or above.
  void LookAtVertices() {
    for (int vertex = 0; vertex < shape_.fractions.cols(); ++vertex) {
      const Place& place = At(vertex);
      if (place.side != 0 && !place.is_round) turns_.push_back({Height(vertex), 0});
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
    if (distinct.size() > kMaxLevels) distinct.resize(kMaxLevels);
    std::sort(distinct.begin(), distinct.end(),
              [](const Turn& a, const Turn& b) { return a.fraction < b.fraction; });
    std::vector<ShapeLevel> levels;
    for (const Turn& turn : distinct) levels.push_back({axis_, turn.fraction});
    return levels;
  }

  // From where to where a triangle reaches.
  std::pair<double, double> Ends(Eigen::Index t) const {
    return std::minmax({Height(shape_.triangles(0, t)), Height(shape_.triangles(1, t)),
                        Height(shape_.triangles(2, t))});
  }

  // Whether a triangle leans against the axis by no more than rounding, or only as chords of a
  // cylinder along it do: cut across, such a one stays as near to that.
  bool RunsAlong(Eigen::Index t, const Eigen::Vector3d& normal, double reach) const {
    if (is_along_[static_cast<std::size_t>(t)]) return true;
    const double lean = std::abs(normal[axis_]);
    return lean <= kAlong || lean * reach <= kOnPlane;
  }

  // Triangles that do not run along the axis, as the faces that they are drawn for: where one ends
  // within its face, as the kernel likes to draw a cone in two rings, the face goes on.
  std::vector<std::vector<int>> BentPieces(const std::vector<SharedEdge>& edges) const {
    const Eigen::Matrix3Xd vertices = shape_.size.asDiagonal() * shape_.fractions;
    const Eigen::Matrix3Xd normals = TriangleNormals(vertices, shape_.triangles);
    std::vector<bool> is_bent;
    for (Eigen::Index t = 0; t < shape_.triangles.cols(); ++t) {
      const auto [low, high] = Ends(t);
      is_bent.push_back(!RunsAlong(t, normals.col(t), (high - low) * shape_.size[axis_]));
    }
    const auto is_bent_at = [&](int t) { return is_bent[static_cast<std::size_t>(t)]; };
    const double sharp = std::cos(kSharpTurn);
    std::vector<std::vector<int>> pieces =
        ConnectedTriangles(shape_.triangles.cols(), edges, [&](const SharedEdge& edge) {
          return is_bent_at(edge.first) && is_bent_at(edge.second) &&
                 shape_.triangle_face(edge.first) == shape_.triangle_face(edge.second) &&
                 normals.col(edge.first).dot(normals.col(edge.second)) >= sharp;
        });
    std::erase_if(pieces,
                  [&](const std::vector<int>& piece) { return !is_bent_at(piece.front()); });
    return pieces;
  }

  // `levels` in order. Of all pieces that do not run along the axis, counts which levels they
  // reach across: one more from the first of them on, one less after the last.
  void MarkDividing(const std::vector<SharedEdge>& edges, std::vector<ShapeLevel>& levels) const {
    if (levels.empty()) return;
    std::vector<int> more(levels.size() + 1, 0);
    const auto first_above = [&](double fraction) {
      const auto found = std::lower_bound(
          levels.begin(), levels.end(), fraction,
          [](const ShapeLevel& level, double sought) { return level.fraction < sought; });
      return static_cast<std::size_t>(found - levels.begin());
    };
    const double near = kOnPlane / shape_.size[axis_];
    for (const std::vector<int>& piece : BentPieces(edges)) {
      double low = 0.5, high = -0.5;
      for (const int t : piece) {
        const auto [from, to] = Ends(t);
        low = std::min(low, from);
        high = std::max(high, to);
      }
      const std::size_t from = first_above(low + near), to = first_above(high - near);
      if (from >= to) continue;
      ++more[from];
      --more[to];
    }
    int across = 0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      across += more[i];
      levels[i].divides = across == 0;
    }
  }

  const DrawnShape& shape_;
  const int axis_;
  const double same_;  // as a fraction
  std::vector<Place> places_ =
      std::vector<Place>(static_cast<std::size_t>(shape_.fractions.cols()));
  // Of each triangle: whether it is of a face whose furthest places are known.
  std::vector<bool> is_round_ =
      std::vector<bool>(static_cast<std::size_t>(shape_.triangles.cols()), false);
  // Of each triangle: whether it is of a cylinder along the axis.
  std::vector<bool> is_along_ =
      std::vector<bool>(static_cast<std::size_t>(shape_.triangles.cols()), false);
  std::vector<Turn> turns_;
};

}  // namespace

std::vector<ShapeLevel> LevelsOf(const DrawnShape& shape) {
  if (!shape.is_solid) return {};
  const std::vector<SharedEdge> edges = SharedEdges(shape.triangles);
  const std::vector<RoundFace> round_faces = RoundFacesOf(shape);
  const std::vector<Countersink> countersinks = CountersinksOf(shape);
  std::vector<ShapeLevel> levels;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<ShapeLevel> along =
        LevelSearch(shape, edges, round_faces, countersinks, axis).Found(edges);
    levels.insert(levels.end(), along.begin(), along.end());
  }
  return levels;
}

}  // namespace mortise::mesh
