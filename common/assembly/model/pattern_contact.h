// Finds what touches only some parts of a pattern, or stands between them and touches none. When
// the number and the places of the pattern's parts change, it might touch none of them, or be run
// into.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/pattern.h"

namespace mortise::parametric {

// A part that touches some parts of a pattern along one of its directions and not all of them, or
// stands between them and touches none.
struct PartialContact {
  int part = 0;       // of the assembly, none of the pattern's
  int direction = 0;  // index into Pattern::directions
  bool stands_between = false;
};

// Returns what touches `parts`, those of a pattern with these directions, in part only. Left out is
// what stands beyond their ends, which do not move in the pattern's box, and what is too long for
// any gap that can come between them. Parts touch where their boxes come within `tolerance`, m, as
// drawn. `parts` has the first direction running fastest. O(n k) for n parts of the assembly and k
// of the pattern.
std::vector<PartialContact> FindPartialContacts(const Assembly& assembly,
                                                const std::array<PatternDirection, 2>& directions,
                                                const std::vector<int>& parts, double tolerance);

// Does the same with only `others`, indices of parts of the assembly, as what may touch.
std::vector<PartialContact> FindPartialContactsWith(
    const std::vector<int>& others, const Assembly& assembly,
    const std::array<PatternDirection, 2>& directions, const std::vector<int>& parts,
    double tolerance);

}  // namespace mortise::parametric
