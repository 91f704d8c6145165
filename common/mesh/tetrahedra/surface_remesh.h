// Gives faces of a surface triangles that a mesher of volumes can work with: the CAD kernel draws a
// long tube with needles from end to end, over which TetGen may fail, and a board with two
// triangles, which say nothing of how large elements may be.
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

// Returns the surface with new triangles on its plane faces, whose edges are about `length`, m,
// long, and shorter where outlines are finer. Curved faces keep their triangles, divided at
// outlines that they share with plane ones: WithCurvedElements takes `surface` as it was. The same
// surface gives the same triangles; RESOURCE_EXHAUSTED as above.
absl::StatusOr<AssemblySurface> WithEvenTriangles(const AssemblySurface& surface, double length);

// What WithEvenTriangles draws anew of a surface, and what it keeps.
struct FaceKinds {
  double plane_area = 0;     // m², of plane faces
  int curved_triangles = 0;  // those of the others
};

FaceKinds KindsOfFaces(const AssemblySurface& surface);

}  // namespace mortise::mesh
