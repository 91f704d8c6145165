// Draws a solid with triangles, face by face.
#pragma once

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

struct SurfaceOptions {
  double deflection = 5e-4;  // m, > 0; largest distance of a triangle from a curved face
  // The same as a share of the diagonal of the solid's box, >= 0. The larger of the two distances
  // holds, so that large solids do not take millions of triangles.
  double relative_deflection = 2e-4;
  double angle = 0.35;  // rad, > 0; largest turn of the normal along a triangle's edge
};

// Returns the closed surface of `solid` as an assembly of one part: triangle_face is the index of
// the solid's face, whose name is the one origin of faces[i]. Points on edges are shared by the
// faces beside them. The point inside the part is not sought: part_interior is empty.
//
// INVALID_ARGUMENT naming the option out of range; INTERNAL if the kernel fails or its triangles
// leave a gap.
absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const Solid& solid,
                                                const SurfaceOptions& options = {});

// Returns the area of the solid's faces, m².
double SurfaceArea(const Solid& solid);

}  // namespace mortise::cad
