// A triangle surface freed from what its file happens to say: the order and orientation of
// triangles, duplicates, triangles without area, place and unit.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// The triangles of a surface in an order that depends on their places alone, along Morton's curve
// through the box around them, so that what follows each other lies close together. Each has its
// corners in the order of their coordinates. Surfaces that differ in the order or orientation of
// triangles, or by exact duplicates, have the same.
struct CanonicalSurface {
  Eigen::Matrix3Xi triangles;  // 3 × T, indices of the surface's own vertices
  Eigen::Index vertices = 0;   // how many vertices the surface has
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m, of the box around the triangles
  double half_size = 1;                              // m, half the largest side of that box
};

// INVALID_ARGUMENT as Descriptor::Bind (descriptor.h). O(T log T).
absl::StatusOr<CanonicalSurface> MakeCanonical(const mesh::SurfaceMesh& surface);

// Vertices moved and scaled so that the box of the reference is [-1, 1]³, which keeps numbers of
// any unit apart from overflow. INVALID_ARGUMENT, "vertices": of another number than the
// reference's, or those of a triangle are not finite.
absl::StatusOr<Eigen::Matrix3Xd> ToReferenceBox(const CanonicalSurface& surface,
                                                const Eigen::Matrix3Xd& vertices);

// Returns how fast they move there. INVALID_ARGUMENT, "velocities[index]", as above.
absl::StatusOr<Eigen::Matrix3Xd> VelocitiesInReferenceBox(const CanonicalSurface& surface,
                                                          const Eigen::Matrix3Xd& velocities,
                                                          Eigen::Index index);

}  // namespace mortise::retrieval
