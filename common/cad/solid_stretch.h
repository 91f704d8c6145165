// Stretches solids by different factors along the axes. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Shape.hxx>

namespace mortise::cad {

// Every point p of `solid` becomes factors ∘ p; factors > 0. Planes stay planes; cylinders, cones
// and whatever is turned about a coordinate axis across which the factors agree stay such;
// cylinders along any coordinate axis become elliptic ones. Solids with other faces become rational
// splines as a whole, which are as exact (BRepBuilderAPI_GTransform). May throw Standard_Failure;
// null if the volume is not what it must be.
TopoDS_Shape StretchSolid(const TopoDS_Shape& solid, const Eigen::Vector3d& factors);

}  // namespace mortise::cad
