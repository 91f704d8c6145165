// Lets rows that repeat together, as planks and the screws in each, do so in every design: what
// fastens a row follows it.
#pragma once

#include <vector>

#include "common/assembly/model/element.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Lets patterns that touch each other and repeat together keep the sizes of their parts along that
// direction, and connecting ones take the counts of the principal ones. It is called after
// MakeElements, before anything that depends on how many parts there are. `tolerance` is in metres.
void FollowPrincipalPatterns(std::vector<Element>& elements, const Contacts& contacts,
                             double tolerance);

}  // namespace mortise::parametric
