// Evaluates a linear template at given parameters: where its parts are, and their meshes. It is
// F(q) of thesis (3.1) for the designs of §3.4 and §3.5.
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
  // The name as drawn. A part that a pattern has beyond those drawn is called as the pattern's
  // first part, with a number.
  std::string name;
  int element = 0;
  BoundingBox box;
  mesh::BoxStretch stretch;  // of its shape into the box
};

// Returns all parts at q, element by element. A pattern has as many as fit its box (pattern.h), so
// their number depends on q. O(parts).
std::vector<PlacedPart> PlaceParts(const Assembly& assembly, const std::vector<Element>& elements,
                                   const Eigen::VectorXd& q);

// Patterns may have no more than this many times as many parts as were drawn: no feasible design
// has, and placing them takes their time.
inline constexpr int kPartGrowthLimit = 20;

// INVALID_ARGUMENT, "q", where patterns would have more parts at q than kPartGrowthLimit allows. q
// must be finite, with positive sizes.
absl::Status CheckPartCount(const Assembly& assembly, const std::vector<Element>& elements,
                            const Eigen::VectorXd& q);

// Returns the box of an element at q.
BoundingBox BoxOf(const Eigen::VectorXd& q, int element);

// Returns the surface of a box, closed and outward.
mesh::SurfaceMesh SurfaceOf(const BoundingBox& box);

// Returns the surface of a part as drawn: that of its shape, or that of its box.
mesh::SurfaceMesh SurfaceOf(const AssemblyPart& part);

// Returns how the shape of element `element` is stretched into a part's box at q: by its feature
// anchors, as far as they keep their order within the box, as they do in every feasible design.
mesh::BoxStretch StretchOf(const std::vector<Element>& elements, int element,
                           const BoundingBox& box, const Eigen::VectorXd& q);

// Returns the surface of a shape in a box whose middle is `center`, m. Its vertices are linear
// functions of the box's centre and size, and of the places of feature anchors: of q, for a part
// that is an element by itself. Where the shape is stretched in proportion:
//
//   vertex k along axis a = centre[a] + fractions(a, k) · size[a]
mesh::SurfaceMesh SurfaceIn(const mesh::DrawnShape& shape, const Eigen::Vector3d& center,
                            const mesh::BoxStretch& stretch);

}  // namespace mortise::parametric
