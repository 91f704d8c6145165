// Solves the equalities of a feasible set: which of them are independent, and what they leave free.
//
// A large set is solved as the hierarchy holds it, deepest groups first: what a group leaves free
// of its own is all that the group above has to do with. So a wall of cupboards takes little longer
// than its cupboards one by one, and a cupboard that was solved before need not be solved again.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <memory>
#include <unordered_map>
#include <vector>

#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// What one system of equalities came to.
struct EqualitySolution {
  std::vector<int> kept;       // which equalities, linearly independent, imply all others
  Eigen::MatrixXd directions;  // unknowns × degrees of freedom, orthonormal: what they leave free
};

// Systems that were solved, by their exact coefficients: whoever asks for one of them is given what
// solving it would give, to the bit. Immutable once it is shared.
class SolvedSystems {
 public:
  struct Entry {
    bool is_reduced = false;
    Eigen::SparseMatrix<double> equalities;  // unknowns × equalities
    std::shared_ptr<const EqualitySolution> solution;
  };

  // Returns the entry of a system; null if it was not solved.
  const Entry* Find(std::size_t hash, bool is_reduced,
                    const Eigen::SparseMatrix<double>& equalities) const;
  void Add(std::size_t hash, Entry entry);
  std::size_t MemoryUse() const;  // bytes

 private:
  std::unordered_multimap<std::size_t, Entry> entries_;
};

// Solves systems, and looks among those that are known before. It keeps what it was asked for, and
// nothing else of what is known. It is not for several threads at once.
class EqualitySolver {
 public:
  explicit EqualitySolver(std::vector<std::shared_ptr<const SolvedSystems>> known = {})
      : known_(std::move(known)) {}

  // Solves equalities that are columns of at most unit length, over the rows. Those that others
  // imply, but for 1e-6 of the lengths that a unit equality speaks of, are left out. A system in
  // what others leave free is `reduced`, and solved by dense QR with pivots; others by sparse QR.
  std::shared_ptr<const EqualitySolution> Solve(const Eigen::SparseMatrix<double>& equalities,
                                                bool is_reduced);

  // Returns all systems that were asked for so far.
  std::shared_ptr<const SolvedSystems> solved() const { return solved_; }

 private:
  std::vector<std::shared_ptr<const SolvedSystems>> known_;
  std::shared_ptr<SolvedSystems> solved_ = std::make_shared<SolvedSystems>();
};

// Variables that change together, and how: q = drawn + directions · z.
struct FreeVariables {
  std::vector<int> variables;  // ascending
  Eigen::MatrixXd directions;  // variables × degrees of freedom, orthonormal
};

struct SolvedEqualities {
  std::vector<const Relationship*> kept;  // linearly independent
  std::vector<FreeVariables> free;        // no variable in two of them
};

// The group of what holds the whole in its place, which is solved last: what stands where is
// nothing to the groups.
inline constexpr int kAboveRoot = -1;

// Solves the equalities among `relationships` over `variables`; they mention no others. Each set of
// variables that equalities connect is solved by itself: at once, or, if it is large and `parents`
// are given, group by group. `parents` has the group above each, kAboveRoot for the root. O(n² m)
// for the largest system of n unknowns and m equalities at worst, much less for chains of planes.
SolvedEqualities SolveEqualities(const std::vector<Relationship>& relationships,
                                 const std::vector<int>& variables, const std::vector<int>& parents,
                                 EqualitySolver& solver);

// The variables of one set that equalities connect, and the equalities among them.
struct EqualityBlock {
  std::vector<int> variables;
  std::vector<const Relationship*> equalities;
};

// Returns all such sets, by any order that is always the same.
std::vector<EqualityBlock> SplitIntoBlocks(const std::vector<Relationship>& relationships,
                                           const std::vector<int>& variables);

// Returns the equalities of a block as unit columns over its variables.
Eigen::SparseMatrix<double> ColumnsOf(const EqualityBlock& block);

}  // namespace mortise::parametric
