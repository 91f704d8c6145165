// Gaps that a drawing has where its parts may be meant to touch.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"

namespace mortise::parametric {

// Says which parts of the elements `loose`, by index, that nothing holds, nearly touch another
// part, by how many millimetres they miss it, and what to do: "; 'shelf' misses 'side' by 0.01 mm,
// which is more than …". The nearest three, no further apart than the largest tolerance that a
// drawing may have closes; empty if there are none. `tolerance`, m, is what counts as touching.
std::string TellOfNearMisses(const Assembly& assembly, const std::vector<Element>& elements,
                             double tolerance, const std::vector<int>& loose);

}  // namespace mortise::parametric
