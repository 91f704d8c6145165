// Moves and resizes a component and the body of a model by as little as lets connections fit: the
// quadratic programme (5.3) of the thesis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/relations/feasible_set.h"
#include "services/composer/connecting/candidate.h"

namespace mortise::composer {

struct FittedSides {
  BothSides sides;
  // m, the largest change of a place or size of a principal part, and of a size in proportion.
  double moved_by = 0;
  double resized_by = 0;
};

// The designs that two sides may be, measured as FitSides measures changes. It depends on their
// assemblies alone, not on how they are now, and takes most of the time of a fit.
struct FitSpaces {
  Eigen::VectorXd component_scales, body_scales;
  parametric::FeasibleSet component, body;
};
FitSpaces FitSpacesOf(const BothSides& sides);

// Returns the largest changes of principal parts between two states of both sides. Rows that got
// another number of parts are compared as far as they have the same.
FittedSides ChangesBetween(const BothSides& before, BothSides after);

// Returns both sides where all these connections have room: the point of the feasible sets of the
// component, free in space, and of the body, together with the connections' hard relationships,
// that is nearest to the present one in all parameters of both. Changes are measured as
// ChangeScales says, places by the body's diagonal; sizes that would change next to nothing stay,
// if they can. Connecting parts reach at least `hold` times as deep into what they hold as drawn
// (hold.h). Parts that a connection has in contact come to lie against each other on the side where
// they do in it. Which parts' edges bound a contact is taken to stay as it is now, which makes the
// programme linear; it is exact unless that changes within the movement.
//
// FAILED_PRECONDITION, CONNECTION_CONFLICT, if there is no such point. Two projections
// (polyhedron.h) in the degrees of freedom of both sides and of the connecting parts.
// `spaces` are those of the two sides.
absl::StatusOr<FittedSides> FitSides(const BothSides& now, const FitSpaces& spaces,
                                     const std::vector<Candidate>& candidates, double hold);

}  // namespace mortise::composer
