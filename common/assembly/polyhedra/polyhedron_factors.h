// A polyhedron as a product of smaller ones: constraints of designs seldom mix axes, and often not
// even the ends of a piece of furniture, so most questions about a large one are questions about
// factors of a few dozen variables.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/assembly/polyhedra/polyhedron.h"

namespace mortise::parametric {

// Variables of a polyhedron that share no constraint with any others, and the rows that speak of
// them; each list ascends.
struct PolyhedronFactor {
  std::vector<int> variables;
  std::vector<int> inequalities;
  std::vector<int> equalities;
};

// All factors, by their first variable: each variable and each row is in exactly one. No row may be
// zero. O((m + k) n).
std::vector<PolyhedronFactor> FactorsOf(const Polyhedron& polyhedron);

// What the factor's rows say of its variables.
Polyhedron PolyhedronOf(const Polyhedron& whole, const PolyhedronFactor& factor);

// The factor's entries of a vector over all variables.
Eigen::VectorXd EntriesOf(const Eigen::VectorXd& whole, const PolyhedronFactor& factor);

// Puts them back.
void SetEntries(const Eigen::VectorXd& entries, const PolyhedronFactor& factor,
                Eigen::VectorXd& whole);

}  // namespace mortise::parametric
