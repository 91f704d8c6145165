// Gives curved faces of a surface triangles that a mesher of volumes can work with: the CAD kernel
// draws a long tube with needles from end to end, over which TetGen may fail.
#pragma once

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Returns the surface with new triangles on its curved faces (CGAL's isotropic remeshing: splits,
// collapses, flips, and smoothing within the old triangles). The surface turns by about `turn`,
// rad, from one to the next, and their edges are not longer than `longest`, m. Outlines of faces
// keep their points and get more where edges are long; plane faces are divided no more than their
// outlines need. Faces that cannot be drawn anew keep their triangles, divided at such outlines.
// The same surface gives the same triangles.
//
// A needle is first divided into as many pieces as it is longer than they should be: seconds for
// some 10,000 pieces. RESOURCE_EXHAUSTED beyond 120,000.
absl::StatusOr<AssemblySurface> WithRoundTriangles(const AssemblySurface& surface, double longest,
                                                   double turn);

}  // namespace mortise::mesh
