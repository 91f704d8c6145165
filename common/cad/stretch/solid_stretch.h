// Stretches solids along the axes. For cad alone: it brings Open CASCADE.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>

#include "common/cad/stretch_map.h"

namespace mortise::cad {

// Returns the solid whose every point has gone where the map takes it. Faces and edges stay in
// their order and become what StretchSurface and StretchCurve make of them, exactly. Returns null
// if what comes out is not valid or its volume not what it must be. May throw Standard_Failure.
//
// Where the map is in proportion, solids with other surfaces or curves (offset ones) become splines
// as a whole, to the kernel's tolerance (BRepBuilderAPI_GTransform); the volume is right to 1e-6,
// and `volume` does not count.
//
// Where the map is in pieces, the solid lies in the box that the map is made for, and every face
// that reaches across a level runs along its axis there: as a plane parallel to it, or a face swept
// along it, which keeps its form. Returns null where that is not so, or where the volume is not
// `volume`, m³, to 1e-2.
TopoDS_Shape StretchSolid(const TopoDS_Shape& solid, const StretchMap& map, double volume);

// Says why StretchSolid returned null: names the faces that have no exact form.
std::string WhyNotStretched(const TopoDS_Shape& solid, const StretchMap& map);

}  // namespace mortise::cad
