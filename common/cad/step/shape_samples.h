// Finds points of edges and faces, by which two of them are compared. Private to this folder: it
// brings Open CASCADE.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <cstddef>
#include <gp_Pnt.hxx>
#include <optional>
#include <vector>

namespace mortise::cad {

// Returns points within an edge or face, several in each stretch of one formula, so that no bend is
// between them. There are none where the ends say all of an edge and the edges all of a face: if it
// is straight or plane. Returns nothing if there would be more than `most`, or if a face is so
// narrow that none is found in it. Throws Standard_Failure.
std::optional<std::vector<gp_Pnt>> PointsWithin(const TopoDS_Edge& edge, std::size_t most);
std::optional<std::vector<gp_Pnt>> PointsWithin(const TopoDS_Face& face, std::size_t most);

// Whether all points are known to be no farther than `tolerance`, m, from the edge or face. Throws
// Standard_Failure.
bool LieOn(const std::vector<gp_Pnt>& points, const TopoDS_Edge& edge, double tolerance);
bool LieOn(const std::vector<gp_Pnt>& points, const TopoDS_Face& face, double tolerance);

}  // namespace mortise::cad
