// What is bound to elements as drawn, whatever pose they are in: patterns to the patterns they
// touch, fasteners to the holes of bought parts, and joints to what they move.
#pragma once

#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Patterns that touch go from their first part to their last at the same distance from each other
// along a direction in which both repeat, to `tolerance`, m: centres and sizes of their boxes
// differ as drawn.
std::vector<Relationship> TiePatterns(const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const Contacts& contacts, double tolerance);

// Connecting elements that reach into one whose item fixes all of its sizes, as screws do into a
// bought handle, keep their place on it across their length: it comes with its holes. Rows of them
// within it go on beginning and ending where they do.
std::vector<Relationship> TieFasteners(const Assembly& assembly,
                                       const std::vector<Element>& elements,
                                       const Contacts& contacts, double tolerance);

// A joint's centre stays where it is against what it moves: in the nearest of `positions`, which
// are those of the drawn pose; or beside it, at a share of the element's size where it lies within
// the element, as what is bored there keeps to.
std::vector<Relationship> TieJoints(const Assembly& assembly, const std::vector<Element>& elements,
                                    const std::vector<PosedPosition>& positions, double tolerance);

}  // namespace mortise::parametric
