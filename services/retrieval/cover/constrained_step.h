// Gauss-Newton steps that keep within the feasible set.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"

namespace mortise::retrieval {

// Returns the change of q (K), within the constraints, that to first order brings the manifold
// nearest to where it should move: min ‖jacobian · change - move‖, and of several changes nearly
// the smallest, each parameter counted in parts of its extent. So that what moves nothing may still
// be used to keep within a bound, it is solved as one quadratic programme, not as a step that is
// cut off. `jacobian` is n × K, `extents` K, `move` n. Fails as ProjectOnto of polyhedron.h.
absl::StatusOr<Eigen::VectorXd> ConstrainedStep(const LinearConstraints& constraints,
                                                const Eigen::VectorXd& q,
                                                const Eigen::MatrixXd& jacobian,
                                                const Eigen::VectorXd& extents,
                                                const Eigen::VectorXd& move);

}  // namespace mortise::retrieval
