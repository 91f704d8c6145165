// Finds the places along a front that have a point: what the cells of the performance buffer leave
// of all that has been evaluated.
//
// A cell is a bundle of rays, and by itself would keep only what is nearest to the ideal. Where the
// front runs along the rays, as it does towards the best of each metric, whole stretches of it lie
// in one cell, and the nearest would hide the rest, the best design of a metric with it. So a cell
// is cut across its rays too, into parts as long as it is wide, and the ends of the front have
// places of their own.
//
// These statements hold for the trade-offs that come first in their places, for any archive and any
// scaling:
//   - for each metric, the least and the greatest value are those of all entries of the archive
//     that are feasible and not dominated, to the last bit;
//   - so a limit of one metric, at any value between these, keeps something;
//   - each such entry has the first of a place of its cell at most as far from the ideal, and
//     nearer by no more than the cell is wide there (or delta_B, if that is more), scaled.
#pragma once

#include <cstddef>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/performance_buffer.h"

namespace mortise::pareto {

// Returns the ends of a front: entries that none dominates and that are the best, or the worst, of
// those in a metric. Their indices ascend, and there are at most 2 d. Of several that are equal in
// the metric it is the lexicographically least.
std::vector<std::size_t> EndsOfFront(const Archive& archive);

struct FrontPlace {
  PerformanceBuffer::CellId cell = 0;
  // The first is a trade-off: nothing dominates it. Those behind it, further from the ideal by at
  // most delta_B, may be dominated, and may stand for it; none do for an end.
  std::vector<PerformanceBuffer::Candidate> candidates;
};

// Returns the places by cell, then by distance from the ideal. No entry is in two places. O(n log
// n) for n trade-offs.
std::vector<FrontPlace> PlacesOfFront(const Archive& archive, const PerformanceBuffer& buffer);

}  // namespace mortise::pareto
