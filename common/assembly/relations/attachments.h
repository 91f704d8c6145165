// Binds to elements, whatever pose they are in, what belongs to them as drawn: patterns to the
// patterns they touch, fasteners to the holes of bought parts, and joints to what they move.
#pragma once

#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Ties patterns that touch: from their first part to their last they stay at the same distance from
// each other along a direction in which both repeat, to `tolerance`, m. Centres and sizes of their
// boxes differ as drawn.
std::vector<Relationship> TiePatterns(const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const Contacts& contacts, double tolerance);

// Ties connecting elements to an element they reach into whose item fixes all of its sizes, as
// screws reach into a bought handle. They keep their place on it across their length, since it
// comes with its holes. Rows of them within it go on beginning and ending where they do.
std::vector<Relationship> TieFasteners(const Assembly& assembly,
                                       const std::vector<Element>& elements,
                                       const Contacts& contacts, double tolerance);

// Ties each joint's centre to what it moves. The centre stays in the nearest of `positions`, which
// are those of the drawn pose, or at its distance from it. Where it lies within the element, it
// stays at its share of the element's size, as what is bored there does.
std::vector<Relationship> TieJoints(const Assembly& assembly, const std::vector<Element>& elements,
                                    const std::vector<PosedPosition>& positions, double tolerance);

}  // namespace mortise::parametric
