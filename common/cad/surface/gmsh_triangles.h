// Triangulates faces by triangles about as wide as they are high (through Gmsh). The kernel's
// triangles follow round faces with needles, over which a mesher of volumes fails or makes many
// times the elements. Private to this folder: it brings Open CASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

struct GmshTriangles {
  Eigen::Matrix3Xd vertices;      // 3 × V, m; those on edges that faces share are shared
  Eigen::Matrix3Xi triangles;     // 3 × T, counter-clockwise seen from where their face points
  Eigen::VectorXi triangle_face;  // T
  // The vertex of each face and each node of the triangulation that it has now, from 1.
  std::vector<std::vector<int>> nodes;
};

// Triangulates faces that share edges, with edges of about lengths[i], m, on faces[i], shorter
// where a face runs along a smaller one. The triangulation of each face becomes the new one, with
// places (u, v) if the face is no plane. The same faces give the same triangles.
//
// Fails as MeshWithGmsh does (gmsh_mesh.h); INTERNAL where its triangles do not lie on the faces.
absl::StatusOr<GmshTriangles> TriangulateWithGmsh(const std::vector<TopoDS_Face>& faces,
                                                  const std::vector<double>& lengths);

}  // namespace mortise::cad
