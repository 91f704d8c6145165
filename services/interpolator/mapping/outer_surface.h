// The outside of a mesh, or of the triangles of a design, as a surface that can be mapped, and the
// way back from places on it to nodes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"
#include "services/interpolator/mapping/disk_map.h"
#include "services/interpolator/mapping/marked_surface.h"
#include "services/interpolator/mapping/surface_map.h"

namespace mortise::interpolator {

// The outer triangles between corners of a mesh.
struct OuterSurface {
  MarkedSurface marked;
  // Of each vertex. Where the mesh touches itself in a node or along an edge, several have the same
  // (sheet_separation.h).
  std::vector<int> node;
  // Of quadratic elements: 3 × triangles, the nodes in the middles of the sides 01, 12, 20.
  Eigen::Matrix3Xi middles;
};

// A place in a triangle between three nodes, or vertices, of the source.
struct NodePlace {
  Eigen::Vector3i nodes = Eigen::Vector3i::Constant(-1);
  Eigen::Vector3d shares = Eigen::Vector3d::Zero();  // barycentric: not negative, of sum 1
};

// Makes the surface of outward triangles between nodes, 3 × T. Vertices come in the order in which
// triangles name them, copies for other sheets behind them. `middles`: 3 × T, or empty.
OuterSurface MakeOuterSurface(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix3Xi& triangles,
                              const Eigen::Matrix3Xi& middles = {});

// Makes the surface of all parts of a mesh together.
OuterSurface OuterSurfaceOf(const mesh::TetrahedralMesh& mesh);

// Returns places that `map` found in triangles of `marked`, of the first `count` vertices, as
// places in the triangles of the surface that its control variables were placed on.
std::vector<TrianglePlace> PlacesBeforeMarking(const mesh::SurfaceMesh& given,
                                               const MarkedSurface& marked, const SurfaceMap& map,
                                               std::size_t count);

// Moves positions in triangles of the source's surface to where the curved sides of its quadratic
// elements have them. `nodes`: of the source.
void FollowCurvedSides(const Eigen::Matrix3Xd& nodes, const OuterSurface& source, SurfaceMap& map);

// Returns the directions in which vertices of the target may slide, 3 × vertices: along a face that
// is flat around them, and at their places in the source, and lies in a plane of two axes. Control
// points and paths of `marked`, the target's surface with them, keep their places.
Eigen::Array3Xi SlidesOnFlatFaces(const OuterSurface& source, const OuterSurface& target,
                                  const MarkedSurface& marked,
                                  const std::vector<TrianglePlace>& places);

// Lets vertices of one node of the target be at one place, the mean of their own.
void JoinSheets(const OuterSurface& target, Eigen::Matrix3Xd& positions);

// Returns places in triangles of an outer surface as places between its nodes; those of no triangle
// stay without.
std::vector<NodePlace> PlacesInNodes(const OuterSurface& outer,
                                     const std::vector<TrianglePlace>& places);

}  // namespace mortise::interpolator
