// Places the connecting elements of a connection anew when its principal elements are moved,
// resized or exchanged for others (thesis §3.6, §5.6):
//
//   minimise  sum of (weight · soft(q))²   over the connecting elements' q
//   such that every hard relationship holds, the principals and patches being given.
//
// The equalities of the unknowns do not depend on the principals, only their right-hand sides do:
// they are solved once, u = A⁺ r(principals) + N z, with N orthonormal in the metric of the soft
// relationships. What is left for each set of principals is the projection of a point z* onto a
// polyhedron (polyhedron.h), in as many variables as the connecting elements are free: exact, with
// the conflict known if there is none.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/connections/connection.h"
#include "common/assembly/model/linear_design.h"

namespace mortise::parametric {

struct OptimizedConnection {
  Eigen::VectorXd q;                     // of the connection: principals and patches as given
  std::vector<BoundingBox> connecting;   // m, of each connecting element
  std::vector<ConnectionPatch> patches;  // as the principals now meet
  // The connecting elements' parts: patterns with as many as they need (pattern.h). `element` is an
  // index into ElementConnection::elements.
  std::vector<PlacedPart> parts;
  double hard_residual = 0;  // m, the largest amount by which a hard relationship is missed
  double soft_residual = 0;  // m, root of the sum that is minimised
};

// Immutable; safe to share between threads.
class ConnectionOptimizer {
 public:
  // Takes O(unknowns² · relationships), dense.
  explicit ConnectionOptimizer(ElementConnection connection);

  const ElementConnection& connection() const { return connection_; }

  // Returns how many numbers the hard relationships leave to the soft ones.
  int degrees_of_freedom() const { return static_cast<int>(free_.cols()); }

  // Returns the connection for principals that fill these boxes (m, in the order of the
  // connection's elements). For the principals as drawn it is the connection as drawn. Hard
  // relationships hold to 1e-9 m.
  //
  // Errors: INVALID_ARGUMENT, "principals" or "principals[i]", for another number of boxes, or one
  // that is not finite or has no size. FAILED_PRECONDITION with CONNECTION_APART if principals that
  // touched no longer do, or meet from another side; with CONNECTION_CONFLICT naming hard
  // relationships that cannot hold together, none of them superfluous. It takes well under a
  // millisecond for a dozen elements.
  absl::StatusOr<OptimizedConnection> Optimize(const std::vector<BoundingBox>& principals) const;

 private:
  // Relationships as rows of coefficients over the unknowns.
  struct Rows {
    std::vector<int> relationships;  // index into hard, or soft
    Eigen::MatrixXd coefficients;    // rows × unknowns
  };

  Rows RowsOf(const std::vector<int>& hard) const;
  void SplitHard();
  void SolveEqualities();
  void UseSoftMetric();
  absl::Status CheckPrincipals(const std::vector<BoundingBox>& principals) const;
  absl::StatusOr<std::vector<ConnectionPatch>> PatchesOf(
      const std::vector<BoundingBox>& principals) const;
  // Returns the values of the relationships at q, m.
  Eigen::VectorXd ValuesAt(const Rows& rows, const Eigen::VectorXd& q) const;
  absl::Status CheckDecided(const Eigen::VectorXd& q) const;
  absl::Status ConflictOf(const std::vector<int>& inequalities) const;
  absl::Status Conflict(const Eigen::VectorXd& combination, std::vector<int> relationships) const;
  OptimizedConnection Finish(Eigen::VectorXd q, std::vector<ConnectionPatch> patches) const;

  ElementConnection connection_;
  Eigen::VectorXd given_;       // q as drawn, its unknowns 0
  Rows equalities_;             // independent
  Rows implied_;                // equalities that those decide, but for what the principals are
  Rows inequalities_;           // that bear on what is free
  Rows decided_;                // inequalities that the equalities decide
  Eigen::MatrixXd solve_;       // A⁺: unknowns × equalities
  Eigen::MatrixXd free_;        // N: unknowns × degrees of freedom
  Eigen::MatrixXd soft_;        // soft relationships × unknowns, weighted
  Eigen::MatrixXd soft_frame_;  // Q of soft · N: soft relationships × degrees of freedom
  Eigen::MatrixXd inequality_free_;  // inequalities · N
};

}  // namespace mortise::parametric
