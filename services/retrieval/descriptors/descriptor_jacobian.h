// The derivative of a descriptor by the parameters of a family of shapes.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

// A family of surfaces, F of the thesis: parameters q, K of them, to a surface whose triangles are
// the same at all q (a template at one choice of its counts).
struct SurfaceFamily {
  Eigen::VectorXd lower;  // K, the box of the parameters; lower < upper
  Eigen::VectorXd upper;  // K
  std::function<absl::StatusOr<mesh::SurfaceMesh>(const Eigen::VectorXd& q)> surface;
  // Where it is known: ∂V/∂q_k for each k, 3 × V, m by unit of q_k. Otherwise empty.
  std::function<absl::StatusOr<std::vector<Eigen::Matrix3Xd>>(const Eigen::VectorXd& q)>
      velocities = {};
};

// Returns how the vertices of a family move with each parameter, K fields of 3 × V: what it says
// itself, otherwise central differences of the vertices (second order one-sided ones at a bound of
// the box) with steps of 1/1000 of each parameter's range. Those are exact but for rounding where
// the vertices are linear or quadratic in q, as those of a template converted from a mesh (§4.6.1).
//
// Errors: those of the family; INVALID_ARGUMENT, "q", of another size than the box or outside of
// it; FAILED_PRECONDITION, TRIANGLES_CHANGE, "q", if the triangles change within the steps.
absl::StatusOr<std::vector<Eigen::Matrix3Xd>> VertexVelocities(const SurfaceFamily& family,
                                                               const Eigen::VectorXd& q);

// Returns the descriptor M(q) of the family's member at q, with its derivative J, N × K (thesis
// §4.4.2), by the chain rule: the vertices' velocities, and the descriptor's derivative along them,
// which is exact for "d2" and "voxel" and a central difference for "light-field" (see their
// headers).
//
// `bound`: the descriptor bound to some member of the family. With one member for all q, what is
// found at different q belongs to one smooth function. Errors as VertexVelocities and
// BoundDescriptor::Differentiate.
absl::StatusOr<DescriptorDerivatives> DescriptorJacobian(const BoundDescriptor& bound,
                                                         const SurfaceFamily& family,
                                                         const Eigen::VectorXd& q);

}  // namespace mortise::retrieval
