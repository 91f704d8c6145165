// Finds the control variables of a surface whose triangles belong to named faces: places where
// three or more faces meet, and the edges between two (thesis §6.6.2). It knows triangles only, so
// that it serves assemblies of parts that touch, cages and imported shapes alike; of models of
// features the kernel knows more (templates/features/edge_samples.h).
//
// A vertex is named by the faces around it, counter-clockwise seen from outside from the lowest
// name on: "seat/x_max | seat/y_max | seat/z_max". An edge is named by its two faces and what its
// ends would be called; it has the lower face on its left. So names agree at two parameters only
// where nothing around the vertex or edge has merged, split or gone, and do not depend on the
// triangles. What has the same name as another has none.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/control_variables.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Triangles are counter-clockwise seen from outside. Where the surface is open or more than two of
// its triangles meet in a side, edges end without a name for their end.
struct FacedSurface {
  Eigen::Matrix3Xd vertices;            // 3 × V, m
  Eigen::Matrix3Xi triangles;           // 3 × T
  std::vector<int> triangle_face;       // T, index into `face_names`
  std::vector<std::string> face_names;  // faces of the same name are one
};

// Returns the outer triangles, corners only, of a surface or mesh of an assembly (surface_mesh.h,
// tetrahedral_mesh.h): `triangle_face` tells which of `faces` a triangle lies on, one column of 3
// or 6 vertices each. A face is named as its origins, "seat/z_max", or "z_max" where there is one
// part.
FacedSurface OuterFaces(const Eigen::Matrix3Xd& vertices, const Eigen::MatrixXi& triangles,
                        const Eigen::VectorXi& triangle_face,
                        const std::vector<AssemblyFace>& faces,
                        const std::vector<std::string>& part_names);

// Returns the points and paths. Edges are sampled as SampleEdge does (edge_sampling.h) with
// `spacing`, m. Closed ones begin where they cross the half plane from their centre along the first
// of the axes x, y and z that lies in their plane, more or less ("… around from y"); those that do
// so at several places, or are so bent that they enclose nothing, have no points. `vertex` is set
// of points where three faces meet.
//
// INVALID_ARGUMENT naming "spacing" unless it is positive and finite; RESOURCE_EXHAUSTED as
// SampleEdge. The same surface gives the same points in the same order. O(T log T).
absl::StatusOr<ControlVariables> FindControlVariables(const FacedSurface& surface, double spacing);

}  // namespace mortise::mesh
