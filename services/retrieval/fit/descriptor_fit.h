// The first part of a fit: parameters nearer to a query by the descriptor that it was found by.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/fit/family_member.h"

namespace mortise::retrieval {

// From a member, a few Gauss-Newton steps within the constraints towards the descriptor of a
// query: of its vectors, one for each turn, the nearest. The descriptor is bound to the member
// and follows its vertices; where the triangles become others, the steps end, and none is taken
// from a member whose like are meshed anew. Never returns parameters whose design is further by the
// descriptor than the member. Fails as MakeMember and
// Descriptor::Bind. It takes two derivatives of the descriptor or so, and few designs.
absl::StatusOr<Eigen::VectorXd> NearerByDescriptor(const Descriptor& descriptor,
                                                   const std::vector<Eigen::VectorXd>& query,
                                                   const FitFamily& family, FamilyMember member,
                                                   int threads);

}  // namespace mortise::retrieval
