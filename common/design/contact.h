// Faces of parts as polygons in space, the patches where parts touch, and whether parts penetrate.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "common/design/evaluated_design.h"

namespace mortise::parametric {

// Planes further apart than this do not touch, and overlaps deeper than this are penetrations: far
// below what a saw can hold, far above rounding. m.
inline constexpr double kContactTolerance = 1e-6;

// A face of a part: a polygon in the plane of u and v, counter-clockwise seen from outside.
struct PlanarFace {
  Eigen::Vector3d origin;  // m
  Eigen::Vector3d u;       // unit vectors; u × v = normal
  Eigen::Vector3d v;
  Eigen::Vector3d normal;    // outwards
  Eigen::Matrix2Xd polygon;  // m, in (u, v) from origin
};

// Returns the index of the face of this name; -1 if the part has none.
int FindFace(const EvaluatedPart& part, const std::string& name);

// Returns the face of this index (as in face_names). u runs along the outline's edge on a side,
// along an axis of the design on the ends.
PlanarFace FaceOf(const EvaluatedPart& part, int face);

// A patch where a face meets another part.
struct ContactPatch {
  PlanarFace face;                       // the plane and its axes
  std::vector<Eigen::Matrix2Xd> pieces;  // m, in (u, v); disjoint and convex; none if no contact
  double area = 0;                       // m²
  Eigen::Vector2d minimum;               // m, bounding rectangle in (u, v)
  Eigen::Vector2d maximum;
};

// Returns the exact overlap of a face with the faces of `other` that lie against it.
ContactPatch FindContact(const EvaluatedPart& part, int face, const EvaluatedPart& other);

// Returns the least distance by which one of two parts must be moved so that their interiors are
// apart; 0 if they are. Exact for convex parts; for others, of the deepest pair of convex pieces.
// m.
double PenetrationDepth(const EvaluatedPart& a, const EvaluatedPart& b);

// Returns the depth as PenetrationDepth does, between two pegs as 12-sided prisms around their
// cylinders.
double PenetrationDepth(const EvaluatedConnector& a, const EvaluatedConnector& b);

// Calls `visit` with each pair of pegs, the lesser index first, of which the middles are so near
// each other that they may meet, until it returns false; in no order, but always the same. O(n) for
// pegs that lie about as far apart as they are long.
void ForNearPegs(const std::vector<EvaluatedConnector>& pegs,
                 const std::function<bool(std::size_t, std::size_t)>& visit);

// Whether the cylinder of radius `radius` from `start` along the unit vector `direction` for
// `length` lies within the part (its surface included).
bool ContainsCylinder(const EvaluatedPart& part, const Eigen::Vector3d& start,
                      const Eigen::Vector3d& direction, double length, double radius);

}  // namespace mortise::parametric
