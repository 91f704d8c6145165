// The feasible set of a linear template is all parameters q that keep every relationship. It is
// kept in a small well-posed form (thesis §3.3, §3.5.1):
//
// q = drawn + basis · z, with z free but for inequalities. The equalities are solved once and for
// all. Columns of the basis are orthonormal, so distances in z are distances in q, each parameter
// measured by its scale.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/assembly/polyhedra/polyhedron_shadow.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

class EqualitySolver;  // equality_solver.h
struct SolvedEqualities;

// A relationship that parameters break, with the amount in metres.
struct Violation {
  std::string description;
  double amount = 0;
};

// A demand that a designer insists on: form(q) = value, m.
struct Demand {
  LinearForm form;
  double value = 0;
  std::string description;  // for people: "width of 'top' is 1.2 m"
};

// The values that a form takes, m.
struct Range {
  double minimum = 0;
  double maximum = 0;
};

class FeasibleSet {
 public:
  // `drawn` must satisfy the relationships (FAILED_PRECONDITION names those it breaks by more than
  // 1e-9 m). Only the parameters in `variables` may change; relationships mention no others.
  // Equalities that others imply, but for 1e-6 of the lengths they speak of as drawings do, are
  // left out (equality_solver.h). With `parents`, the group above each, large sets of variables
  // that equalities connect are solved group by group; a `solver` need not solve again what it
  // knows.
  static absl::StatusOr<FeasibleSet> Create(std::vector<Relationship> relationships,
                                            const Eigen::VectorXd& drawn,
                                            const std::vector<int>& variables,
                                            const std::vector<int>& parents = {},
                                            EqualitySolver* solver = nullptr);

  // Returns the same set with other distances: parameter i counts in units of scales[i] > 0, of
  // which there is one a parameter. INVALID_ARGUMENT, "scales". O(n² |q|) for n degrees of freedom.
  absl::StatusOr<FeasibleSet> Rescaled(const Eigen::VectorXd& scales) const;

  // Returns the set whose members may also be changed along each of these directions (columns, |q|
  // × k), without the relationships that would forbid it: free in space, if the directions move
  // everything. What holds the set along them must be equalities that speak of nothing else, as
  // Anchor has them. O(n² |q|).
  FeasibleSet FreedAlong(const Eigen::MatrixXd& directions) const;

  // Returns how many numbers z has: what a designer may really choose.
  int degrees_of_freedom() const { return static_cast<int>(basis_.cols()); }

  const Eigen::VectorXd& drawn() const { return drawn_; }  // z = 0
  const Eigen::MatrixXd& basis() const { return basis_; }  // |q| × degrees of freedom

  // Returns the equalities that are kept: linearly independent, and with the same solutions as all
  // given.
  const std::vector<Relationship>& equalities() const { return equalities_; }

  // Returns the inequalities that bear on z, none parallel to a tighter one.
  const std::vector<Relationship>& inequalities() const { return inequalities_; }

  // Returns the same in z: normals · z <= slacks, in rows of unit length.
  const Eigen::MatrixXd& normals() const { return normals_; }
  const Eigen::VectorXd& slacks() const { return slacks_; }

  // Returns which relationships, of all that were given, q breaks by more than `tolerance`, m.
  std::vector<Violation> Violations(const Eigen::VectorXd& q, double tolerance) const;

  // Returns the feasible parameters nearest to `wish` in least squares over all that may change,
  // among those that meet the demands exactly: what becomes of a design when somebody drags a part
  // of it (thesis §3.5.1). Parameters that may not change are as drawn, whatever the wish.
  // INVALID_ARGUMENT for a wish or demand of wrong size or not finite; FAILED_PRECONDITION,
  // DEMANDS_CONFLICT, naming the demands, inequalities and kept equalities that cannot hold
  // together, none of them superfluous. See polyhedron.h for the method and its cost.
  absl::StatusOr<Eigen::VectorXd> Nearest(const Eigen::VectorXd& wish,
                                          const std::vector<Demand>& demands = {}) const;

  // Returns the feasible parameters that meet the demands and at which `form` is as large as it can
  // be. Fails as Nearest does; FAILED_PRECONDITION, FEASIBLE_SET_UNBOUNDED if it can be as large as
  // one likes. It takes a few projections: see FurthestAlong of polyhedron.h.
  absl::StatusOr<Eigen::VectorXd> Furthest(const LinearForm& form,
                                           const std::vector<Demand>& demands = {}) const;

  // Returns the smallest and the largest value of each form over the set. FAILED_PRECONDITION,
  // FEASIBLE_SET_UNBOUNDED if there is none. It takes a linear programme for each end that lies
  // before its own limit (polyhedron_extents.h).
  absl::StatusOr<std::vector<Range>> RangesOf(const std::vector<LinearForm>& forms) const;

  // Returns which values the forms take together: the set's shadow (polyhedron_shadow.h).
  // INVALID_ARGUMENT for a form that the set does not change; FAILED_PRECONDITION,
  // FEASIBLE_SET_UNBOUNDED, if one has no end.
  absl::StatusOr<PolyhedronShadow> ValuesOf(const std::vector<LinearForm>& forms) const;

  // Returns `count` points at corners of the set: the ends of random directions, seeded. Each
  // factor of the set (polyhedron_factors.h) has directions of its own. Fails as RangesOf does. It
  // takes a linear programme for each corner.
  absl::StatusOr<std::vector<Eigen::VectorXd>> Corners(int count, std::uint64_t seed) const;

  // Returns a change of q that can be followed without end; nothing if there is none, decided
  // exactly.
  absl::StatusOr<std::optional<Eigen::VectorXd>> UnboundedDirection() const;

  // Returns `count` points, each feasible, spread evenly over the set (hit_and_run.h). A seed gives
  // the same points always. FAILED_PRECONDITION, FEASIBLE_SET_UNBOUNDED if the design may move or
  // grow without end in some direction, decided exactly: anchor an element.
  absl::StatusOr<std::vector<Eigen::VectorXd>> Sample(int count, std::uint64_t seed) const;

 private:
  // The set in z with demands that must be met, and the demand that each of its rows stands for.
  struct Held {
    Polyhedron feasible;
    std::vector<const Demand*> demands;
  };

  FeasibleSet() = default;

  void UseSolution(const SolvedEqualities& solved);
  void ReduceInequalities();
  // Makes the columns of the basis orthonormal by the weights, and the inequalities anew.
  void Reframe();
  absl::StatusOr<Eigen::VectorXd> RowOf(const Demand& demand, std::size_t index) const;
  absl::StatusOr<Held> Hold(const std::vector<Demand>& demands) const;
  std::vector<std::string> EqualitiesBehind(const std::vector<const LinearForm*>& forms) const;
  absl::Status ConflictOf(const Held& held, const std::vector<int>& equalities,
                          const std::vector<int>& inequalities) const;

  std::vector<Relationship> all_;
  std::vector<Relationship> equalities_;
  std::vector<Relationship> inequalities_;
  Eigen::VectorXd drawn_;
  Eigen::VectorXd weights_;  // of squares in distances: scales to the power of -2
  Eigen::MatrixXd basis_;
  // inequalities_ in z: normals_ · z <= slacks_.
  Eigen::MatrixXd normals_;  // inequalities × degrees of freedom
  Eigen::VectorXd slacks_;
};

// Holds the centre of an element where it is drawn: a template is the same wherever it stands.
std::vector<Relationship> Anchor(const std::vector<Element>& elements, int element);

// Returns the relationships held by a group and those below it, which are what binds its subtree by
// itself.
std::vector<Relationship> RelationshipsWithin(const Assembly& assembly,
                                              const std::vector<Relationship>& relationships,
                                              int group);

// Returns the parameters of the elements, and of the joints' centres, in a group's subtree.
std::vector<int> VariablesWithin(const Assembly& assembly, const std::vector<Element>& elements,
                                 int group);

}  // namespace mortise::parametric
