// Contact of prisms: coplanar opposite faces are clipped against each other; penetration is the
// smallest overlap over the separating axes of convex pieces.
#include "common/design/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "common/design/polygon.h"

namespace mortise::parametric {
namespace {

using Eigen::Matrix2Xd;
using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kAround = 1.04;  // radius around a 12-sided prism around a cylinder of 1
constexpr double kParallelTolerance = 1e-9;  // 1 - |cosine| of directions that count as parallel

// A convex body by its corners, face normals and edge directions.
struct ConvexBody {
  Matrix3Xd corners;
  std::vector<Vector3d> normals;
  std::vector<Vector3d> edges;
};

void AddDirection(std::vector<Vector3d>& directions, const Vector3d& direction) {
  for (const Vector3d& known : directions) {
    if (std::abs(known.dot(direction)) > 1 - kParallelTolerance) return;
  }
  directions.push_back(direction);
}

// The prism over `polygon` at origin + (u, v), of `height` along u × v.
ConvexBody MakeBody(const Matrix2Xd& polygon, const Vector3d& origin, const Vector3d& u,
                    const Vector3d& v, double height) {
  const Vector3d w = u.cross(v);
  const Eigen::Index count = polygon.cols();
  ConvexBody body;
  body.corners.resize(3, 2 * count);
  AddDirection(body.normals, w);
  AddDirection(body.edges, w);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector2d corner = polygon.col(i);
    body.corners.col(i) = origin + corner.x() * u + corner.y() * v;
    body.corners.col(count + i) = body.corners.col(i) + height * w;
    const Vector2d edge = (polygon.col((i + 1) % count) - polygon.col(i)).normalized();
    AddDirection(body.edges, edge.x() * u + edge.y() * v);
    AddDirection(body.normals, edge.y() * u - edge.x() * v);
  }
  return body;
}

std::vector<ConvexBody> ConvexBodies(const EvaluatedPart& part) {
  const Vector3d u = FromPrismAxes(part.axis, 1, 0, 0);
  const Vector3d v = FromPrismAxes(part.axis, 0, 1, 0);
  const Vector3d origin = FromPrismAxes(part.axis, 0, 0, part.from);
  std::vector<ConvexBody> bodies;
  for (const Matrix2Xd& piece : ConvexPieces(part.outline)) {
    bodies.push_back(MakeBody(piece, origin, u, v, part.to - part.from));
  }
  return bodies;
}

double OverlapAlong(const ConvexBody& a, const ConvexBody& b, const Vector3d& axis) {
  const Eigen::RowVectorXd along_a = axis.transpose() * a.corners;
  const Eigen::RowVectorXd along_b = axis.transpose() * b.corners;
  return std::min(along_a.maxCoeff() - along_b.minCoeff(), along_b.maxCoeff() - along_a.minCoeff());
}

// Separating axis theorem: two convex bodies are apart if they are along a face normal of either or
// a cross product of their edges. The smallest overlap, 0 if apart.
double Depth(const ConvexBody& a, const ConvexBody& b) {
  double depth = std::numeric_limits<double>::infinity();
  const auto separates = [&](const Vector3d& axis) {
    depth = std::min(depth, OverlapAlong(a, b, axis));
    return depth <= 0;
  };
  for (const Vector3d& normal : a.normals) {
    if (separates(normal)) return 0;
  }
  for (const Vector3d& normal : b.normals) {
    if (separates(normal)) return 0;
  }
  for (const Vector3d& edge_a : a.edges) {
    for (const Vector3d& edge_b : b.edges) {
      const Vector3d axis = edge_a.cross(edge_b);
      if (axis.norm() > 1e-6 && separates(axis.normalized())) return 0;
    }
  }
  return depth;
}

// The distance between the axes of two pegs, as segments (Ericson, Real-Time Collision Detection,
// 5.1.9).
double AxisDistance(const EvaluatedConnector& a, const EvaluatedConnector& b) {
  const Vector3d start_a = a.position - a.depth_in_part * a.direction;
  const Vector3d start_b = b.position - b.depth_in_part * b.direction;
  const Vector3d along_a = a.length * a.direction, along_b = b.length * b.direction;
  const Vector3d between = start_a - start_b;
  const double aa = along_a.squaredNorm(), bb = along_b.squaredNorm();
  const double ab = along_a.dot(along_b);
  const double da = along_a.dot(between), db = along_b.dot(between);
  const double determinant = aa * bb - ab * ab;
  double s = determinant > kParallelTolerance * aa * bb
                 ? std::clamp((ab * db - da * bb) / determinant, 0.0, 1.0)
                 : 0;
  double t = (ab * s + db) / bb;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((ab * t - da) / aa, 0.0, 1.0);
  }
  return (between + s * along_a - t * along_b).norm();
}

ConvexBody PegBody(const EvaluatedConnector& peg) {
  constexpr int kSides = 12;
  const Vector3d u = peg.direction.unitOrthogonal();
  const Vector3d v = peg.direction.cross(u);
  const double radius = peg.diameter / 2 / std::cos(std::numbers::pi / kSides);
  Matrix2Xd polygon(2, kSides);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    polygon.col(i) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return MakeBody(polygon, peg.position - peg.depth_in_part * peg.direction, u, v, peg.length);
}

}  // namespace

int FindFace(const EvaluatedPart& part, const std::string& name) {
  const auto found = std::find(part.face_names.begin(), part.face_names.end(), name);
  return found == part.face_names.end() ? -1 : static_cast<int>(found - part.face_names.begin());
}

PlanarFace FaceOf(const EvaluatedPart& part, int face) {
  const Vector3d u = FromPrismAxes(part.axis, 1, 0, 0);
  const Vector3d v = FromPrismAxes(part.axis, 0, 1, 0);
  const Vector3d w = FromPrismAxes(part.axis, 0, 0, 1);
  const Eigen::Index sides = part.outline.cols();
  PlanarFace result;
  if (face < sides) {
    const Vector2d from = part.outline.col(face), to = part.outline.col((face + 1) % sides);
    const double length = (to - from).norm(), height = part.to - part.from;
    result.origin = FromPrismAxes(part.axis, from.x(), from.y(), part.from);
    result.u = ((to - from).x() * u + (to - from).y() * v) / length;
    result.v = w;
    result.polygon.resize(2, 4);
    result.polygon << 0, length, length, 0, 0, 0, height, height;
  } else if (face == sides) {
    // Seen from below, counter-clockwise is the other way round.
    result.origin = FromPrismAxes(part.axis, 0, 0, part.from);
    result.u = v;
    result.v = u;
    result.polygon = part.outline.colwise().reverse().rowwise().reverse();
  } else {
    result.origin = FromPrismAxes(part.axis, 0, 0, part.to);
    result.u = u;
    result.v = v;
    result.polygon = part.outline;
  }
  result.normal = result.u.cross(result.v);
  return result;
}

ContactPatch FindContact(const EvaluatedPart& part, int face, const EvaluatedPart& other) {
  ContactPatch patch;
  patch.face = FaceOf(part, face);
  patch.minimum.setConstant(std::numeric_limits<double>::infinity());
  patch.maximum = -patch.minimum;
  for (int i = 0; i < static_cast<int>(other.face_names.size()); ++i) {
    const PlanarFace opposite = FaceOf(other, i);
    if (patch.face.normal.dot(opposite.normal) > -1 + kParallelTolerance) continue;
    if (std::abs(patch.face.normal.dot(opposite.origin - patch.face.origin)) > kContactTolerance) {
      continue;
    }
    // In the plane of the first face the opposite polygon runs clockwise: turn it round.
    const Eigen::Index count = opposite.polygon.cols();
    Matrix2Xd polygon(2, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Vector2d corner = opposite.polygon.col(count - 1 - k);
      const Vector3d offset =
          opposite.origin + corner.x() * opposite.u + corner.y() * opposite.v - patch.face.origin;
      polygon.col(k) << offset.dot(patch.face.u), offset.dot(patch.face.v);
    }
    for (const Matrix2Xd& piece : Intersect(patch.face.polygon, polygon, kContactTolerance)) {
      patch.area += SignedArea(piece);
      patch.minimum = patch.minimum.cwiseMin(piece.rowwise().minCoeff());
      patch.maximum = patch.maximum.cwiseMax(piece.rowwise().maxCoeff());
      patch.pieces.push_back(piece);
    }
  }
  return patch;
}

double PenetrationDepth(const EvaluatedPart& a, const EvaluatedPart& b) {
  const Vector3d overlap = a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum);
  if (overlap.minCoeff() <= kContactTolerance) return 0;
  double deepest = 0;
  const std::vector<ConvexBody> bodies_b = ConvexBodies(b);
  for (const ConvexBody& body_a : ConvexBodies(a)) {
    for (const ConvexBody& body_b : bodies_b) deepest = std::max(deepest, Depth(body_a, body_b));
  }
  return deepest;
}

double PenetrationDepth(const EvaluatedConnector& a, const EvaluatedConnector& b) {
  // The corners of the prisms lie somewhat outside of the cylinders.
  if (AxisDistance(a, b) > kAround * (a.diameter + b.diameter) / 2) return 0;
  return Depth(PegBody(a), PegBody(b));
}

void ForNearPegs(const std::vector<EvaluatedConnector>& pegs,
                 const std::function<bool(std::size_t, std::size_t)>& visit) {
  // Cells are as large as the farthest that two middles may be apart, so that those of a peg's cell
  // and its neighbours are all that may be near.
  double reach = 0;
  std::vector<Vector3d> middles;
  for (const EvaluatedConnector& peg : pegs) {
    reach = std::max(reach, peg.length + peg.diameter);
    middles.emplace_back(peg.position + (peg.length / 2 - peg.depth_in_part) * peg.direction);
  }
  using Cell = std::array<std::int64_t, 3>;
  std::vector<std::pair<Cell, std::size_t>> sorted;
  for (std::size_t i = 0; i < pegs.size(); ++i) {
    const Vector3d at = middles[i] / reach;
    sorted.push_back({{static_cast<std::int64_t>(std::floor(at.x())),
                       static_cast<std::int64_t>(std::floor(at.y())),
                       static_cast<std::int64_t>(std::floor(at.z()))},
                      i});
  }
  std::sort(sorted.begin(), sorted.end());
  const auto is_near = [&](std::size_t i, std::size_t j) {
    const double farthest =
        (pegs[i].length + pegs[j].length + pegs[i].diameter + pegs[j].diameter) / 2;
    return (middles[i] - middles[j]).norm() <= farthest;
  };
  for (const auto& [cell, i] : sorted) {
    for (int row = 0; row < 9; ++row) {
      // Cells that follow each other along z lie together in the order.
      const std::int64_t x = cell[0] + row / 3 - 1, y = cell[1] + row % 3 - 1;
      const Cell end{x, y, cell[2] + 2};
      const std::pair from(Cell{x, y, cell[2] - 1}, std::size_t{0});
      for (auto near = std::lower_bound(sorted.begin(), sorted.end(), from);
           near != sorted.end() && near->first < end; ++near) {
        const std::size_t j = near->second;
        if (j > i && is_near(i, j) && !visit(i, j)) return;
      }
    }
  }
}

bool ContainsCylinder(const EvaluatedPart& part, const Vector3d& start, const Vector3d& direction,
                      double length, double radius) {
  constexpr int kAround = 16, kStations = 5;
  const Vector3d p = direction.unitOrthogonal(), q = direction.cross(p);
  const Vector3d u = FromPrismAxes(part.axis, 1, 0, 0), v = FromPrismAxes(part.axis, 0, 1, 0);
  const Vector3d w = FromPrismAxes(part.axis, 0, 0, 1);
  for (int station = 0; station < kStations; ++station) {
    const Vector3d centre = start + direction * (length * station / (kStations - 1));
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      const Vector3d point = centre + radius * (std::cos(angle) * p + std::sin(angle) * q);
      const double along = point.dot(w);
      if (along < part.from - kContactTolerance || along > part.to + kContactTolerance) {
        return false;
      }
      if (!Contains(part.outline, {point.dot(u), point.dot(v)}, kContactTolerance)) return false;
    }
  }
  return true;
}

}  // namespace mortise::parametric
