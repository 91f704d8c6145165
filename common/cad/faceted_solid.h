// Makes a solid of planar faces from a closed surface of triangles.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

// Returns the solid within a closed, outward surface without self-intersections, which may have
// hollows. Neighbouring triangles of one face that lie in one plane, up to a tenth of a micrometre,
// become one face of the solid, which is called as their face is: several of the solid's faces may
// have one name. `triangle_face` is the index into `face_names` of each triangle.
//
// INVALID_ARGUMENT, "shape", if the surface is open or bounds several solids, if an edge is too
// short for the kernel, with its place, or if the kernel cannot make a face. Whether the surface
// crosses itself is not looked at here, but by IsSound.
absl::StatusOr<Solid> FacetedSolid(const mesh::SurfaceMesh& surface,
                                   const Eigen::VectorXi& triangle_face,
                                   const std::vector<std::string>& face_names,
                                   const std::string& name);

// Whether the kernel finds nothing wrong with a solid: its faces are bounded, meet and do not cross
// each other. Takes about half a millisecond a face.
bool IsSound(const Solid& solid);

}  // namespace mortise::cad
