#include "common/mesh/shapes/round_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "common/mesh/shapes/circle.h"
#include "common/mesh/shared_edges.h"

namespace mortise::mesh {
namespace {

constexpr double kWholeTurn = 2 * std::numbers::pi;
constexpr double kSameCircle = 1e-7;    // m, between circles that are one
constexpr double kSameAngle = 1e-6;     // rad
constexpr double kMinFacing = 0.5;      // cosine, of a triangle's normal with the radius there
constexpr std::size_t kMinCorners = 4;  // seen along the axis: three always lie on a circle

// From `low` on, counter-clockwise, rad; not longer than a turn.
struct Arc {
  double low = 0;
  double high = 0;
};

// A round face as it grows together.
struct Piece {
  RoundFace face;
  Circle circle;
  double low = 0, high = 0;  // m, along the axis
  std::vector<Arc> arcs;     // of its triangles
};

// Triangles that hang together, and their corners.
struct SmoothPiece {
  std::vector<int> triangles;
  std::vector<int> corners;
};

// Finds the round faces along one axis.
class RoundFaceSearch {
 public:
  RoundFaceSearch(const DrawnShape& shape, const Eigen::Matrix3Xd& vertices,
                  const Eigen::Matrix3Xd& normals, int axis)
      : shape_(shape),
        vertices_(vertices),
        normals_(normals),
        axis_(axis),
        across_{(axis + 1) % 3, (axis + 2) % 3} {}

  // Notes a piece if it is round.
  void LookAt(const SmoothPiece& smooth) {
    const auto& [triangles, corners] = smooth;
    const std::optional<Circle> circle = CircleThrough(vertices_(across_, corners));
    if (!circle.has_value() || CountAngles(*circle, corners) < kMinCorners) return;
    Piece piece;
    piece.circle = *circle;
    const Eigen::VectorXd along = vertices_.row(axis_)(corners).transpose();
    piece.low = along.minCoeff();
    piece.high = along.maxCoeff();
    piece.face.is_hollow = Facing(*circle, triangles.front()) < 0;
    for (const int t : triangles) {
      const double facing = Facing(*circle, t);
      if ((piece.face.is_hollow ? -facing : facing) < kMinFacing) return;
      piece.arcs.push_back(ArcOf(*circle, t));
    }
    piece.face.triangles = triangles;
    pieces_.push_back(std::move(piece));
  }

  std::vector<RoundFace> Found() {
    JoinPieces();
    std::vector<RoundFace> faces;
    for (Piece& piece : pieces_) faces.push_back(Completed(piece));
    return faces;
  }

 private:
  Eigen::Vector2d Seen(int vertex) const { return vertices_.col(vertex)(across_); }
  double AngleOf(const Circle& circle, const Eigen::Vector2d& at) const {
    const Eigen::Vector2d radius = at - circle.middle;
    return std::atan2(radius.y(), radius.x());
  }
  Eigen::Vector2d MiddleOf(int t) const {
    return (Seen(shape_.triangles(0, t)) + Seen(shape_.triangles(1, t)) +
            Seen(shape_.triangles(2, t))) /
           3;
  }

  // The cosine between a triangle's normal and the radius at its middle.
  double Facing(const Circle& circle, int t) const {
    const Eigen::Vector2d radius = MiddleOf(t) - circle.middle;
    return normals_.col(t)(across_).dot(radius.normalized());
  }

  std::size_t CountAngles(const Circle& circle, const std::vector<int>& corners) const {
    std::vector<double> angles;
    for (const int corner : corners) angles.push_back(AngleOf(circle, Seen(corner)));
    std::sort(angles.begin(), angles.end());
    std::size_t count = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      if (i == 0 || angles[i] - angles[i - 1] > kSameAngle) ++count;
    }
    return count;
  }

  Arc ArcOf(const Circle& circle, int t) const {
    const double middle = AngleOf(circle, MiddleOf(t));
    Arc arc{middle, middle};
    for (int k = 0; k < 3; ++k) {
      const double turn =
          std::remainder(AngleOf(circle, Seen(shape_.triangles(k, t))) - middle, kWholeTurn);
      arc.low = std::min(arc.low, middle + turn);
      arc.high = std::max(arc.high, middle + turn);
    }
    return arc;
  }

  static bool BelongTogether(const Piece& a, const Piece& b) {
    return a.face.is_hollow == b.face.is_hollow &&
           std::abs(a.circle.radius - b.circle.radius) <= kSameCircle &&
           (a.circle.middle - b.circle.middle).norm() <= kSameCircle &&
           std::max(a.low, b.low) <= std::min(a.high, b.high) + kSameCircle;
  }

  // Faces of one cylinder, as CAD systems draw bores in two halves, become one piece.
  void JoinPieces() {
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
      return a.circle.middle.x() < b.circle.middle.x();
    });
    boost::disjoint_sets_with_storage<> sets(pieces_.size());
    for (std::size_t i = 0; i < pieces_.size(); ++i) sets.make_set(i);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const double furthest = pieces_[i].circle.middle.x() + kSameCircle;
      for (std::size_t j = i + 1; j < pieces_.size(); ++j) {
        if (pieces_[j].circle.middle.x() > furthest) break;
        if (BelongTogether(pieces_[i], pieces_[j])) sets.union_set(i, j);
      }
    }
    std::map<std::size_t, Piece> joined;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const auto [found, is_new] = joined.emplace(sets.find_set(i), pieces_[i]);
      if (!is_new) Join(pieces_[i], found->second);
    }
    pieces_.clear();
    for (auto& [set, piece] : joined) pieces_.push_back(std::move(piece));
  }

  static void Join(const Piece& from, Piece& to) {
    // Of more triangles, the circle is known better.
    if (from.face.triangles.size() > to.face.triangles.size()) to.circle = from.circle;
    to.low = std::min(to.low, from.low);
    to.high = std::max(to.high, from.high);
    to.arcs.insert(to.arcs.end(), from.arcs.begin(), from.arcs.end());
    to.face.triangles.insert(to.face.triangles.end(), from.face.triangles.begin(),
                             from.face.triangles.end());
  }

  // What all arcs together cover of [0, 2π], in order.
  static std::vector<Arc> Covered(const std::vector<Arc>& arcs) {
    std::vector<Arc> turned;  // as they lie in that range, once or twice
    for (const Arc& arc : arcs) {
      const double low = arc.low - kWholeTurn * std::floor(arc.low / kWholeTurn);
      turned.push_back({low, low + arc.high - arc.low});
      turned.push_back({low - kWholeTurn, low - kWholeTurn + arc.high - arc.low});
    }
    std::sort(turned.begin(), turned.end(),
              [](const Arc& a, const Arc& b) { return a.low < b.low; });
    std::vector<Arc> covered;
    for (const Arc& arc : turned) {
      if (!covered.empty() && arc.low <= covered.back().high + kSameAngle) {
        covered.back().high = std::max(covered.back().high, arc.high);
      } else {
        covered.push_back(arc);
      }
    }
    return covered;
  }

  static bool Covers(const std::vector<Arc>& covered, double low, double high) {
    return std::any_of(covered.begin(), covered.end(), [&](const Arc& arc) {
      return arc.low <= low + kSameAngle && arc.high >= high - kSameAngle;
    });
  }

  RoundFace Completed(Piece& piece) const {
    RoundFace face = std::move(piece.face);
    face.axis = axis_;
    face.middle[axis_] = (piece.low + piece.high) / 2;
    face.middle[across_[0]] = piece.circle.middle.x();
    face.middle[across_[1]] = piece.circle.middle.y();
    face.radius = piece.circle.radius;
    face.length = piece.high - piece.low;
    const std::vector<Arc> covered = Covered(piece.arcs);
    face.is_whole = Covers(covered, 0, kWholeTurn);
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t end = 0; end < 2; ++end) {
        const double angle = (i == 0 ? 0 : kWholeTurn / 4) + (end == 1 ? 0 : kWholeTurn / 2);
        face.reaches[static_cast<std::size_t>(across_[i])][end] =
            Covers(covered, angle, angle) ||
            Covers(covered, angle + kWholeTurn, angle + kWholeTurn);
      }
    }
    for (const Arc& arc : piece.arcs) {
      face.widest_arc = std::max(face.widest_arc, arc.high - arc.low);
    }
    std::sort(face.triangles.begin(), face.triangles.end());
    return face;
  }

  const DrawnShape& shape_;
  const Eigen::Matrix3Xd& vertices_;  // m
  const Eigen::Matrix3Xd& normals_;   // of the triangles, outward, of length 1
  const int axis_;
  const std::array<int, 2> across_;
  std::vector<Piece> pieces_;
};

// The triangles of each face, where they hang together without an edge, and are not flat.
std::vector<SmoothPiece> SmoothPieces(const DrawnShape& shape, const Eigen::Matrix3Xd& normals) {
  const double sharp = std::cos(kSharpTurn);
  const auto joins = [&](const SharedEdge& edge) {
    return shape.triangle_face(edge.first) == shape.triangle_face(edge.second) &&
           normals.col(edge.first).dot(normals.col(edge.second)) >= sharp;
  };
  std::vector<SmoothPiece> pieces;
  for (std::vector<int>& triangles :
       ConnectedTriangles(shape.triangles.cols(), SharedEdges(shape.triangles), joins)) {
    const bool is_flat = std::all_of(triangles.begin(), triangles.end(), [&](int t) {
      return (normals.col(t) - normals.col(triangles.front())).norm() <= kSameAngle;
    });
    if (is_flat) continue;
    std::vector<int> corners;
    for (const int t : triangles) {
      for (int k = 0; k < 3; ++k) corners.push_back(shape.triangles(k, t));
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    pieces.push_back({std::move(triangles), std::move(corners)});
  }
  return pieces;
}

}  // namespace

std::vector<RoundFace> RoundFacesOf(const DrawnShape& shape) {
  if (!shape.is_solid) return {};
  const Eigen::Matrix3Xd vertices = shape.size.asDiagonal() * shape.fractions;
  const Eigen::Matrix3Xd normals = TriangleNormals(vertices, shape.triangles);
  const std::vector<SmoothPiece> pieces = SmoothPieces(shape, normals);
  std::vector<RoundFace> faces;
  for (int axis = 0; axis < 3; ++axis) {
    RoundFaceSearch search(shape, vertices, normals, axis);
    for (const SmoothPiece& piece : pieces) search.LookAt(piece);
    for (RoundFace& face : search.Found()) faces.push_back(std::move(face));
  }
  std::stable_sort(faces.begin(), faces.end(), [](const RoundFace& a, const RoundFace& b) {
    return std::tuple(a.axis, a.middle.x(), a.middle.y(), a.middle.z(), a.radius) <
           std::tuple(b.axis, b.middle.x(), b.middle.y(), b.middle.z(), b.radius);
  });
  return faces;
}

}  // namespace mortise::mesh
