// Finds the smallest box that holds a solid. For cad alone: it brings Open CASCADE.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Shape.hxx>

namespace mortise::cad {

// The corners, m, of the box along the axes to which `rotation` turns the solid.
struct SolidBox {
  Eigen::Vector3d minimum, maximum;
};

// Returns the box of a solid turned by `rotation`. It is exact up to the tolerance of the solid's
// edges, and to 1e-9 of its size elsewhere: a solid reaches farthest at a vertex, at a place where
// an edge runs across the direction, or at one where a face looks along it. All of these are found,
// in closed form for lines, conics, planes, cylinders, cones, balls and tori. Faces of splines take
// about a millisecond each.
SolidBox BoxOf(const TopoDS_Shape& solid, const Eigen::Matrix3d& rotation);

}  // namespace mortise::cad
