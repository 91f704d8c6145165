// Makes quadratic elements follow curved faces instead of the triangles these were drawn with.
#pragma once

#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

// Returns the mesh with its nodes on faces moved to where `surface.exact` has them: isoparametric
// elements, whose sides on a curved face miss it by the fourth power of their length, not the
// second.
//
// Within each triangle the way from it to the face is taken as the quadratic polynomial through its
// corners and the middles of its sides, so that nodes between those follow too. Nodes inside the
// parts stay, but for middles of sides, which remain halfway between their corners. Elements that
// would turn inside out keep straight sides between corners on the faces or, where that is not
// enough, stay as they are.
//
// `mesh` is as MeshAssembly or RefineMesh make it of `surface`, with straight sides. Linear meshes,
// and all meshes of a surface without exact places, are returned as they are. O((E + T) log T) for
// E elements and T triangles.
TetrahedralMesh WithCurvedElements(const AssemblySurface& surface, TetrahedralMesh mesh);

}  // namespace mortise::mesh
