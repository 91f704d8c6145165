// Simple polygons in the plane: checks, triangulation and exact overlaps. A polygon is a 2 × N
// matrix of corners, counter-clockwise, not repeated at the end.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace mortise::parametric {

// Returns half the sum of cross products, m²: positive for counter-clockwise polygons.
double SignedArea(const Eigen::Matrix2Xd& polygon);

// Whether no two edges cross or touch except neighbours at their common corner, no edge is shorter
// than `tolerance`, and no edge doubles back on its neighbour. m.
bool IsSimple(const Eigen::Matrix2Xd& polygon, double tolerance);

// Whether a counter-clockwise polygon has no reflex corner.
bool IsConvex(const Eigen::Matrix2Xd& polygon);

// Cuts ears off a simple counter-clockwise polygon: N - 2 counter-clockwise triangles of corner
// indices that use every corner. O(N²).
std::vector<std::array<int, 3>> Triangulate(const Eigen::Matrix2Xd& polygon);

// Returns the polygon itself if it is convex, its triangles otherwise.
std::vector<Eigen::Matrix2Xd> ConvexPieces(const Eigen::Matrix2Xd& polygon);

// Returns the overlap of two simple polygons as disjoint convex pieces, leaving out pieces that are
// thinner than `tolerance` (area at most tolerance × longest extent). m.
std::vector<Eigen::Matrix2Xd> Intersect(const Eigen::Matrix2Xd& a, const Eigen::Matrix2Xd& b,
                                        double tolerance);

// Whether a point lies inside a polygon or within `tolerance` of its boundary.
bool Contains(const Eigen::Matrix2Xd& polygon, const Eigen::Vector2d& point, double tolerance);

}  // namespace mortise::parametric
