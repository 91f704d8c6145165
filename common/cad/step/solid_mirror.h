// Mirrors and scales solids, and finds whether one is its own mirror image. Private to this folder:
// it brings Open CASCADE.
#pragma once

#include <Eigen/Geometry>
#include <TopoDS_Shape.hxx>
#include <optional>

namespace mortise::cad {

// Returns the solid `scale` times as large, from the origin, and if asked for mirrored across the
// plane z = 0. Throws Standard_Failure.
TopoDS_Shape DistortedSolid(const TopoDS_Shape& solid, double scale, bool mirrored);

// Returns the mirror that makes the solid of itself, as most screws and boards have one: places of
// vertices, edges and faces, points within these, their sizes and the moments of inertia agree to a
// millionth of the size. It looks at planes through the centre of mass across the axes of the frame
// and of inertia, and through vertices and those or middles of edges. It returns nothing if there
// is none, or if that is in doubt, as with solids of very many edges. Throws Standard_Failure.
std::optional<Eigen::Affine3d> OwnMirror(const TopoDS_Shape& solid);

}  // namespace mortise::cad
