// Divides the parts of an assembly into tetrahedra (through TetGen).
#pragma once

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

struct MeshOptions {
  // Wanted edge length, m: no element is larger than the regular tetrahedron of this edge. 0
  // chooses DefaultElementSize(assembly).
  double element_size = 0;

  // Largest allowed ratio of an element's circumradius to its shortest edge. The regular
  // tetrahedron has 0.61; smaller limits give rounder and more elements. Flat boards need a
  // generous limit, or their thickness dictates the size of every element. At least 1.1.
  double radius_edge_ratio = 4.0;

  // Smallest wanted angle between two faces of an element, rad; not guaranteed near sharp edges.
  double minimum_dihedral = 0.09;

  // Divides no triangle of the surface, which else become so small that elements are not much wider
  // than the part is thick. For surfaces whose triangles are as large as elements are to be
  // (surface_remesh.h); not for RefineMesh.
  bool keep_triangles = false;

  // 10-node elements with straight edges, else 4-node ones.
  bool quadratic = true;

  // RESOURCE_EXHAUSTED beyond this many elements, mostly before any work is done.
  int element_limit = 2'000'000;
};

// Returns a size at which an assembly of boards gets a few thousand elements: a twelfth of the
// diagonal of its bounding box, but not so small that volume alone would ask for more than 20,000.
// Parts that are thin for their area take more all the same: element_budget.h bounds them.
double DefaultElementSize(const AssemblySurface& assembly);

// Returns how many elements of `element_size` fill the assembly's volume; a lower bound on what
// meshing gives, since thin parts and small faces need more.
double EstimateElements(const AssemblySurface& assembly, double element_size);

// Meshes every part; touching parts share nodes (they are bonded). Triangles on the faces of the
// assembly are kept as face_triangles: outward on the outside, towards `front_part` where two parts
// touch. The same input gives the same mesh.
//
// Errors: INVALID_ARGUMENT names the option, or the part and place where the surface is open,
// inside out or crosses itself; RESOURCE_EXHAUSTED if it would take more than `element_limit`
// elements; INTERNAL if TetGen fails on a sound surface, or makes elements without volume, at other
// sizes too (0.93 and 0.87 times as large) and with round triangles on curved faces
// (surface_remesh.h).
//
// TetGen runs in a process of its own (tetgen_process.h).
absl::StatusOr<TetrahedralMesh> MeshAssembly(const AssemblySurface& assembly,
                                             const MeshOptions& options = {});

// Returns the mesh with every element of more than the volume of a regular tetrahedron of edge
// sizes[e] (m) divided, and those beside them as good shapes need. Others mostly stay; nothing
// becomes coarser. Parts, faces and what they enclose stay exactly the same. In a quadratic mesh
// the corners count: it must have straight edges. `options.element_size` has no effect. The same
// input gives the same mesh.
//
// Errors as MeshAssembly's; INVALID_ARGUMENT naming "sizes" unless there is a positive one for each
// element; RESOURCE_EXHAUSTED before any work is done where EstimateRefinement is beyond
// `element_limit`.
absl::StatusOr<TetrahedralMesh> RefineMesh(const TetrahedralMesh& mesh,
                                           const Eigen::VectorXd& sizes,
                                           const MeshOptions& options = {});

// Returns how many elements these sizes take at least. RefineMesh makes about two to three times as
// many, since sizes are the largest that elements may have.
double EstimateRefinement(const TetrahedralMesh& mesh, const Eigen::VectorXd& sizes);

// Returns the outside of a volume mesh as triangles between corners (3 × T node indices), outward;
// each quadratic face triangle is split in four. Includes only faces of elements of `part`, or of
// all parts together with -1.
Eigen::Matrix3Xi OuterTriangles(const TetrahedralMesh& mesh, int part = -1);

}  // namespace mortise::mesh
