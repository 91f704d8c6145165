// Finds the shadow that a polyhedron of many variables casts on a few: which values linear forms of
// its points can have together. For the sizes that a designer may choose of a design it is what the
// rest of the design leaves open, as inequalities among those sizes alone.
//
// Fourier and Motzkin's elimination makes far more inequalities than there are faces. Here rays are
// shot from the inside of the shadow, each a linear programme whose multipliers say which face it
// meets; first in random directions, then at corners of what the faces found leave, which is where
// faces are missing, until none of many corners lies outside.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace mortise::parametric {

// The values y with inequalities · y <= bounds: rows of unit length.
struct PolyhedronShadow {
  Eigen::MatrixXd inequalities;  // faces × forms
  Eigen::VectorXd bounds;        // faces
};

// Returns the shadow that inequalities · x <= bounds cast by y = forms · x. Each of its
// inequalities is met by every y of the shadow, and by one of them with equality, to 1e-7 of their
// size; of their corners in random directions 64 in a row lie within the shadow, unless it has more
// than some thousands of faces. Where
// forms depend on each other, or the polyhedron is flat, there are two inequalities for an
// equality. The same arguments give the same shadow.
//
// INVALID_ARGUMENT if sizes disagree, numbers are not finite or a row is zero. FAILED_PRECONDITION,
// POLYHEDRON_EMPTY or, where a form has no end, POLYHEDRON_UNBOUNDED. It takes a few hundred linear
// programmes in the variables of each factor (polyhedron_factors.h) that forms speak of.
absl::StatusOr<PolyhedronShadow> ShadowOf(const Eigen::MatrixXd& inequalities,
                                          const Eigen::VectorXd& bounds,
                                          const Eigen::MatrixXd& forms);

}  // namespace mortise::parametric
