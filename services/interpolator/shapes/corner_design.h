// What of a design canonical meshes are made of, and what is brought into them: the corners of its
// elements, and which of its triangles are outside. Private to this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fields/design_fields.h"
#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::interpolator {

// Returns the design with corners of elements alone: 4-node tetrahedra and 3-node triangles in the
// same order, the nodes that they name in the same order, and what nodes have. With `with_elements`
// false it is the surface alone, without tetrahedra and what is of them. Control points at nodes
// that are dropped keep their position; paths lead through the nodes that are left. The design has
// passed fields::Check; one that has been through here comes out the same.
fields::DesignFields CornersOf(const fields::DesignFields& design, bool with_elements = true);

// The triangles between corners that lie on the outside.
struct OuterTriangles {
  Eigen::Matrix3Xi triangles;  // 3 × F nodes, counter-clockwise seen from outside
  Eigen::VectorXi part;        // F: the part behind; -1 if it has none
  std::vector<int> element;    // F: the tetrahedron behind; -1 of a surface alone
  std::vector<int> outer_of;   // of each given triangle: its number here, or -1
  // Of a surface alone with 6-node triangles: 3 × F, the middles of the sides 01, 12, 20; or empty.
  Eigen::Matrix3Xi middles;
};

// Finds them: with tetrahedra the faces that only one has, otherwise the given triangles that have
// the outside on one side or both. Those given come first, in their order.
OuterTriangles FindOuterTriangles(const fields::DesignFields& design);

// Returns the outer triangles as they are curved, for measuring: each given one of 6 nodes as the
// four between these.
mesh::SurfaceMesh FineSurface(const fields::DesignFields& design, const OuterTriangles& outer);

// Returns a design's surface alone, without tetrahedra and what is of them.
fields::DesignFields WithoutElements(fields::DesignFields design);

// A surface with vertices of its own.
struct NodeSurface {
  mesh::SurfaceMesh surface;
  std::vector<int> node;  // of each vertex, ascending
};

// Returns the surface that some triangles between nodes make.
NodeSurface SurfaceOf(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix3Xi& triangles);

// Returns the elements of a design, of as many nodes as they have.
mesh::TetrahedralMesh ElementsOf(const fields::DesignFields& design);

}  // namespace mortise::interpolator
