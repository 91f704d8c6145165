// Takes a scene apart into the pieces that its surface consists of.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "common/mesh/scenes/scene.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// A piece of a surface. It need not be closed.
struct SurfacePiece {
  int component = 0;       // index of the component of the scene that it is a piece of
  SurfaceMesh surface;     // in the scene's unit; its corners are apart from each other
  bool is_closed = false;  // whether each edge has two triangles, whichever way these turn
};

// Returns the pieces of a scene, component by component, in the order of their first triangles.
//
// What hangs together by corners is one piece (mesh_components.h), but for closed shells: where a
// table's legs and its top are boxes that share corners or edges only, each box is a piece. A shell
// is what hangs together by edges of exactly two triangles, and it is closed if none of its edges
// has another number of them; boxes that share a whole face are one piece. A triangle that is drawn
// again at the same corners, as for both sides of a sheet, goes with the first and counts as one.
// What is left of a component without its closed shells hangs together by corners again. The rule
// is our own.
//
// Corners nearer to each other than a millionth of the scene's diagonal are one; triangles that
// have no three corners then are left out.
std::vector<SurfacePiece> PiecesOf(const Scene& scene);

// Returns the box around a surface, which must have vertices.
Eigen::AlignedBox3d BoxOf(const SurfaceMesh& surface);

}  // namespace mortise::mesh
