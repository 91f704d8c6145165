// What is covered: the manifold that a family of designs is in descriptor space, M(q) = D(F(q)) for
// all feasible parameters q (thesis §4.3).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::retrieval {

// The feasible parameters: all q with normals · q <= bounds. They must be bounded.
struct LinearConstraints {
  Eigen::MatrixXd normals;  // m × K, no row zero
  Eigen::VectorXd bounds;   // m
};

// Returns the constraints of a box: lower <= q <= upper, 2 K rows.
LinearConstraints BoxConstraints(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

// Returns what keeps both.
LinearConstraints BothConstraints(const LinearConstraints& a, const LinearConstraints& b);

// Returns how far q may go along `direction`, as a multiple of it, until it meets a constraint; 0
// where it stands on one. Infinity if nothing stops it.
double RoomAlong(const LinearConstraints& constraints, const Eigen::VectorXd& q,
                 const Eigen::VectorXd& direction);

// Returns the width of the feasible set along each parameter (K), by two linear programmes each.
// FAILED_PRECONDITION if it is unbounded or empty.
absl::StatusOr<Eigen::VectorXd> ExtentsOf(const LinearConstraints& constraints);

// The derivatives of M at a point.
struct Derivatives {
  Eigen::MatrixXd first;   // N × K: column k is ∂M/∂q_k
  Eigen::MatrixXd second;  // N × K: column k is ∂²M/∂q_k²
  long evaluations = 0;    // as many as they took, or as much work
};

// A family's manifold. All methods may be called on several threads at once, and answer the same
// whenever they are asked the same.
//
// K parameters are what may be chosen: for an assembly z of its FeasibleSet (the box of its
// parameters is not the feasible set), otherwise the template's parameters within their box. The
// descriptor may have fewer directions than K (all of ours ignore size): that is found out.
class Manifold {
 public:
  virtual ~Manifold() = default;

  virtual Eigen::Index parameters() const = 0;  // K
  virtual Eigen::Index dimension() const = 0;   // N
  virtual const LinearConstraints& constraints() const = 0;

  // `count` feasible points, spread evenly. A seed gives the same points always.
  virtual absl::StatusOr<std::vector<Eigen::VectorXd>> Sample(int count,
                                                              std::uint64_t seed) const = 0;

  // M(q), N numbers. An error, or a number that is not finite, means that this design cannot be
  // evaluated: the cover leaves it out and counts it.
  virtual absl::StatusOr<Eigen::VectorXd> Evaluate(const Eigen::VectorXd& q) const = 0;

  // Designs of different structure (counts of parts, choices) lie on different manifolds, which are
  // covered apart. Asked only where Evaluate succeeds.
  virtual int Structure(const Eigen::VectorXd& q) const;

  // Returns the error of an evaluation, as a part of what the descriptor changes by over the
  // feasible set: rounding for a smooth descriptor, much more for one that counts pixels. Central
  // differences take their steps from it.
  virtual double noise() const { return 1e-12; }

  // Whether DerivativesAt is better than central differences.
  virtual bool OffersDerivatives() const { return false; }

  // Returns the derivatives at q; by default central differences (differences.h).
  virtual absl::StatusOr<Derivatives> DerivativesAt(const Eigen::VectorXd& q) const;
};

}  // namespace mortise::retrieval
