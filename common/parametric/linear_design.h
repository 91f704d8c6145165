// A linear template at given parameters: where its parts are, and their meshes, F(q) of thesis
// (3.1) for the designs of §3.4 and §3.5.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/mesh/surface_mesh.h"
#include "common/parametric/assembly.h"
#include "common/parametric/element.h"

namespace mortise::parametric {

// One part at q, in the pose the design is drawn in.
struct PlacedPart {
  // As drawn; of parts that a pattern has more than were drawn, its first part's with a number.
  std::string name;
  int element = 0;
  BoundingBox box;
};

// All parts at q, element by element. A pattern has as many as fit its box (pattern.h), so their
// number depends on q. O(parts).
std::vector<PlacedPart> PlaceParts(const Assembly& assembly, const std::vector<Element>& elements,
                                   const Eigen::VectorXd& q);

// The box of an element at q.
BoundingBox BoxOf(const Eigen::VectorXd& q, int element);

// A surface whose vertices are linear functions of a box's centre and size: of q, for a part that
// is an element by itself.
//
//   vertex k along axis a = centre[a] + fractions()(a, k) · size[a]
class LinearMesh {
 public:
  // What `drawn` becomes when `box`, around it as drawn, is moved and resized. Each axis of the box
  // must have a size.
  LinearMesh(mesh::SurfaceMesh drawn, const BoundingBox& box);

  // 3 × V; between -1/2 and 1/2 within the box.
  const Eigen::Matrix3Xd& fractions() const { return fractions_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }

  // The vertices in another box, 3 × V, m.
  Eigen::Matrix3Xd VerticesIn(const BoundingBox& box) const;

  mesh::SurfaceMesh In(const BoundingBox& box) const;

 private:
  Eigen::Matrix3Xd fractions_;
  Eigen::Matrix3Xi triangles_;
};

// The surface of a box, closed and outward.
mesh::SurfaceMesh SurfaceOf(const BoundingBox& box);

}  // namespace mortise::parametric
