// The smallest box that holds a solid. Private to this folder: it brings Open CASCADE.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Shape.hxx>

namespace mortise::cad {

// The corners, m, of the box along the axes to which `rotation` turns the solid.
struct SolidBox {
  Eigen::Vector3d minimum, maximum;
};

// Exact up to the tolerance of the solid's edges, and to 1e-9 of its size elsewhere: what a solid
// reaches farthest with is a vertex, a place where an edge runs across the direction or one where a
// face looks along it; all of these are found, of lines, conics, planes, cylinders, cones, balls
// and tori in closed form. Faces of splines take about a millisecond each.
SolidBox BoxOf(const TopoDS_Shape& solid, const Eigen::Matrix3d& rotation);

}  // namespace mortise::cad
