// Finds fasteners that join nothing, as where a board became thinner than its screws are long.
#pragma once

#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/design/template_definition.h"
#include "services/composer/holding/finding.h"

namespace mortise::composer {

inline constexpr char kJoinsNothing[] = "joins-nothing";

// Returns the screws, bolts and dowels of an assembly, as it is drawn, that join nothing, our own,
// a warning each:
//
//   joins-nothing  it goes into no part, or into one alone and touches no hardware, such as a
//                  bracket, hinge or nut. A bolt or dowel may carry what only touches it, as the
//                  pegs below a shelf do; a screw must go into it
//
// Depths are of boxes, so that what is round counts as going into all of its box. O(parts²).
std::vector<Finding> FindLooseFasteners(const parametric::Assembly& drawn,
                                        const std::vector<parametric::Item>& items,
                                        const std::vector<parametric::Material>& materials);

}  // namespace mortise::composer
