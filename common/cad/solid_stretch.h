// Stretches solids by different factors along the axes. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Shape.hxx>
#include <string>

namespace mortise::cad {

// Every point p of `solid` becomes factors ∘ p; factors > 0. Its faces and edges stay in their
// order and become what StretchSurface and StretchCurve make of them, exactly. Solids with other
// surfaces or curves (offset ones) become splines as a whole, to the kernel's tolerance
// (BRepBuilderAPI_GTransform). May throw Standard_Failure; null if what comes out is not valid or
// its volume not what it must be, to 1e-6.
TopoDS_Shape StretchSolid(const TopoDS_Shape& solid, const Eigen::Vector3d& factors);

// What to say of a solid for which that is null: the faces that have no exact form.
std::string WhyNotStretched(const TopoDS_Shape& solid);

}  // namespace mortise::cad
