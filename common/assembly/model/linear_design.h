// A linear template at given parameters: where its parts are, and their meshes, F(q) of thesis
// (3.1) for the designs of §3.4 and §3.5.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/mesh/shapes/box_stretch.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::parametric {

// One part at q, in the pose the design is drawn in.
struct PlacedPart {
  // As drawn; of parts that a pattern has more than were drawn, its first part's with a number.
  std::string name;
  int element = 0;
  BoundingBox box;
  mesh::BoxStretch stretch;  // of its shape into the box
};

// All parts at q, element by element. A pattern has as many as fit its box (pattern.h), so their
// number depends on q. O(parts).
std::vector<PlacedPart> PlaceParts(const Assembly& assembly, const std::vector<Element>& elements,
                                   const Eigen::VectorXd& q);

// INVALID_ARGUMENT, "q", where patterns would have so many parts at q that there are more than
// kPartGrowthLimit times as many as drawn: no feasible design has, and placing them takes their
// time. q is finite, with positive sizes.
inline constexpr int kPartGrowthLimit = 20;
absl::Status CheckPartCount(const Assembly& assembly, const std::vector<Element>& elements,
                            const Eigen::VectorXd& q);

// The box of an element at q.
BoundingBox BoxOf(const Eigen::VectorXd& q, int element);

// The surface of a box, closed and outward.
mesh::SurfaceMesh SurfaceOf(const BoundingBox& box);

// The surface of a part as drawn: its shape's, or that of its box.
mesh::SurfaceMesh SurfaceOf(const AssemblyPart& part);

// How the shape of element `element` is stretched into a part's box at q: its held levels, as far
// as they keep their order within the box, as in every feasible design.
mesh::BoxStretch StretchOf(const std::vector<Element>& elements, int element,
                           const BoundingBox& box, const Eigen::VectorXd& q);

// The surface of a shape in a box whose middle is `center`, m. Its vertices are linear functions of
// the box's centre and size, and of the places of held levels: of q, for a part that is an element
// by itself. In proportion:
//
//   vertex k along axis a = centre[a] + fractions(a, k) · size[a]
mesh::SurfaceMesh SurfaceIn(const mesh::DrawnShape& shape, const Eigen::Vector3d& center,
                            const mesh::BoxStretch& stretch);

}  // namespace mortise::parametric
