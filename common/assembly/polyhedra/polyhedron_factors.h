// Splits a polyhedron into a product of smaller ones. Constraints of designs seldom mix axes, and
// often not even the ends of a piece of furniture, so most questions about a large polyhedron are
// questions about factors of a few dozen variables.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/assembly/polyhedra/polyhedron.h"

namespace mortise::parametric {

// The variables of a polyhedron that share no constraint with any others, and the rows that speak
// of them. Each list ascends.
struct PolyhedronFactor {
  std::vector<int> variables;
  std::vector<int> inequalities;
  std::vector<int> equalities;
};

// Returns all factors, by their first variable: each variable and each row is in exactly one. No
// row may be zero. O((m + k) n).
std::vector<PolyhedronFactor> FactorsOf(const Polyhedron& polyhedron);

// Returns the factor as a polyhedron: what its rows say of its variables.
Polyhedron PolyhedronOf(const Polyhedron& whole, const PolyhedronFactor& factor);

// Returns the factor's entries of a vector over all variables.
Eigen::VectorXd EntriesOf(const Eigen::VectorXd& whole, const PolyhedronFactor& factor);

// Puts the factor's entries back into a vector over all variables.
void SetEntries(const Eigen::VectorXd& entries, const PolyhedronFactor& factor,
                Eigen::VectorXd& whole);

}  // namespace mortise::parametric
