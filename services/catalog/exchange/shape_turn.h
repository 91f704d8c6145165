// Whether one shape is another, turned: drawings place a product as often as it is used, each time
// turned, and what is read of them has a shape for each.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::catalog {

// Returns the turn by right angles that makes `to` of `from`, both as drawn (their own turns do not
// count), to a tenth of a micrometre; none if there is none. The triangles are compared, the exact
// volume, and the moments of inertia. O(V) for each of 24 turns that the boxes allow.
std::optional<Eigen::Matrix3d> TurnBetween(const mesh::DrawnShape& from,
                                           const mesh::DrawnShape& to);

// For each shape the first of them that is the same as drawn, unturned, or itself: parts that were
// each drawn where they stand differ by rounding, and would be no row if they were told apart.
std::vector<int> FirstAlike(const std::vector<mesh::DrawnShape>& shapes);

}  // namespace mortise::catalog
