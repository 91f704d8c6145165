// Places all connecting elements of a design once its principals stand. It minimises what the soft
// relationships of every connection are missed by, at once, within the design's own feasible set
// (thesis §3.6: "the parameters of the connecting elements are optimized using these additional
// relationships as soft constraints").
//
// ConnectionOptimizer does so for one connection by itself; in a design its connections are also
// related to each other.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/connections/connection.h"
#include "common/assembly/polyhedra/linear_form.h"
#include "common/assembly/relations/feasible_set.h"

namespace mortise::parametric {

// Immutable; safe to share between threads.
class ConnectionPlacement {
 public:
  // Prepares the placement for a design with these elements and connections. O(degrees of freedom²
  // · parameters).
  ConnectionPlacement(const FeasibleSet& feasible_set, const std::vector<Element>& elements,
                      std::vector<ElementConnection> connections);

  const std::vector<ElementConnection>& connections() const { return connections_; }

  // Returns how many numbers of the connecting elements neither the principals nor relationships
  // determine.
  int degrees_of_freedom() const { return static_cast<int>(free_.cols()); }

  // Returns the design with the principals of `q` in which the soft relationships hold best, and
  // `held` have the values they have at q. `q` must be feasible (to 1e-9 m), and so is the result.
  // It takes a projection in degrees_of_freedom() variables (polyhedron.h).
  absl::StatusOr<Eigen::VectorXd> Place(const Eigen::VectorXd& q,
                                        const std::vector<LinearForm>& held) const;

 private:
  void FindFree(const FeasibleSet& feasible_set, const std::vector<Element>& elements);
  void UseSoftMetric();
  // Returns the index into the design's q of a connection's parameter; -1 for a patch's.
  int DesignVariable(const ElementConnection& connection, int variable) const;
  Eigen::VectorXd Along(const LinearForm& form) const;  // form · free
  Eigen::VectorXd MissesAt(const Eigen::VectorXd& q) const;

  std::vector<ElementConnection> connections_;
  int elements_ = 0;
  std::vector<LinearForm> inequalities_;  // that bear on what is free
  Eigen::MatrixXd inequality_free_;       // inequalities · free
  Eigen::MatrixXd free_;        // |q| × degrees of freedom, orthonormal for the soft rows
  Eigen::MatrixXd soft_frame_;  // soft relationships × degrees of freedom, orthonormal
};

}  // namespace mortise::parametric
