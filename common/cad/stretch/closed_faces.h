// Cuts open faces that close on themselves, as those of balls, rings and some splines do. For
// cad alone: it brings Open CASCADE.
#pragma once

#include <TopoDS_Shape.hxx>

namespace mortise::cad {

bool HasClosedFaces(const TopoDS_Shape& solid);

inline constexpr int kWaysToCutOpen = 4;

// Returns the solid with such faces in pieces that do not close; the cuts lie elsewhere for each
// `way`, 0 to kWaysToCutOpen - 1, as one that runs along or through an edge may fail. Whether what
// comes out is valid is not looked at; null if the kernel fails. May throw Standard_Failure.
TopoDS_Shape CutOpen(const TopoDS_Shape& solid, int way);

}  // namespace mortise::cad
