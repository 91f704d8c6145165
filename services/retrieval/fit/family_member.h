// A design of a family with how its surface moves when parameters change.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "services/retrieval/cover/manifold.h"
#include "services/retrieval/descriptors/descriptor_jacobian.h"

namespace mortise::retrieval {

// What is fitted: F of the thesis over its feasible set. Functions are called on several threads at
// once, and fail where a design cannot be made.
struct FitFamily {
  // The surface may have other triangles at other q: counts change, and surfaces of solids are
  // meshed anew each time.
  SurfaceFamily surfaces;
  // What is feasible of the box, as far as it is known beforehand: an assembly cannot have all its
  // sizes together. No rows for all of it.
  LinearConstraints cuts = {};
};

struct FamilyMember {
  Eigen::VectorXd q;                         // K
  mesh::SurfaceMesh surface;                 // m
  std::vector<Eigen::Matrix3Xd> velocities;  // K of 3 × V: m by unit of each parameter
  bool meshed_anew = false;  // whether members beside it have other triangles, as those of solids

  // Returns the surface at other parameters, to first order.
  mesh::SurfaceMesh At(const Eigen::VectorXd& other) const;
};

// Returns the box with the cuts.
LinearConstraints ConstraintsOf(const FitFamily& family);

// Returns the parameters within the constraints that are nearest to q, each counted in parts of its
// range. FAILED_PRECONDITION where there are none.
absl::StatusOr<Eigen::VectorXd> NearestFeasible(const FitFamily& family, const Eigen::VectorXd& q);

// Returns the member at q. Velocities are the family's own; else by differences of vertices over a
// thousandth of each range; where triangles differ, as those of solids do, they are how fast the
// faces move along their normals, by differences over a fiftieth. With `threads`, parameters are
// looked at in parallel. It makes a member for each parameter, or one more where triangles differ.
// Fails where the member or one beside it cannot be made.
absl::StatusOr<FamilyMember> MakeMember(const FitFamily& family, const Eigen::VectorXd& q,
                                        int threads);

// Returns the member at q, with the velocities of one not far away where they still hold: where its
// surface is, but for a small part of how far it has moved, where these say. That part may be
// larger where each member is meshed anew, as these take long: whoever goes on from there by the
// surface as it is needs only a few more steps. Otherwise as MakeMember.
absl::StatusOr<FamilyMember> MoveMember(const FitFamily& family, const FamilyMember& from,
                                        const Eigen::VectorXd& q, int threads);

}  // namespace mortise::retrieval
