// Says how long the edges of triangles should be on each face. Private to this folder: it brings
// Open CASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

namespace mortise::cad {

// Returns the least radius of curvature, m, of each face but for a twentieth of its area. It is
// taken at the middles of the face's triangles, which it must have, and is infinite for planes.
std::vector<double> LeastRadii(const std::vector<TopoDS_Face>& faces);

// Returns the length of edges, m, on a face of this radius in a mesh of elements of `element_size`,
// m. A surface turns by half a radian from one triangle to the next, or by a radian where it is so
// round that elements would become much smaller than wanted.
double EdgeLength(double radius, double element_size);

}  // namespace mortise::cad
