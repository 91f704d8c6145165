// Canonical meshes and blended shapes as messages.
#pragma once

#include <cstddef>
#include <vector>

#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

// Returns the mesh in parts that follow one another, all but the last with `more`: of at most
// `most` bytes of triangles, tetrahedra, parts and regions each, but for one name of a region. A
// region that is cut has its name in each. `structure`, `mesh`: which it is of the
// map. SURFACE has the triangles on the outside and the nodes that they need.
std::vector<v1::MapMesh> MeshMessages(const CanonicalMesh& canonical, int structure, int mesh,
                                      v1::GeometryKind geometry, std::size_t most);

// Returns messages that follow one another: a shape and its mesh, which is `mesh`, in parts. The
// shape comes last, with the last part where a message of `most` bytes can hold both; else an empty
// part ends the mesh there.
std::vector<v1::MapShape> WithMesh(v1::MapShape shape, std::vector<v1::MapMesh> mesh,
                                   std::size_t most);

// Sets the positions and fields of a shape; `canonical` is its mesh. Errors are left out.
void SetShape(const BlendedShape& blended, const CanonicalMesh& canonical, v1::MapShape& shape);

}  // namespace mortise::interpolator
