// Packs items into the cheapest bins: the integer problem behind crosscutting boards.
//
// Given sizes s_i and bin types with capacity C_t and cost c_t, both as integers, find bins that
// hold every item once, each bin within its capacity, at least total cost. This is strongly
// NP-hard, and solved by
//   1. best-fit and first-fit decreasing, and minimum bin slack (Gupta and Ho 1999: fill one bin as
//      full as possible around the largest item left, again and again);
//   2. bin completion (Martello and Toth 1990, Korf 2002): branch over the ways to complete the bin
//      of the largest item left, fullest first, cut off by lower bounds, up to a number of steps.
// Lower bounds: the total size at the best price per size, and L2 of Martello and Toth. Equal sizes
// are counted, not enumerated, so a thousand copies cost little more than one.
#pragma once

#include <cstdint>
#include <vector>

namespace mortise::fabplanner {

struct BinType {
  int64_t capacity = 0;  // > 0
  int64_t cost = 1;      // > 0
};

struct PackedBin {
  int type = 0;            // index of the bin type
  std::vector<int> items;  // indices of the items, largest first
};

struct Packing {
  std::vector<PackedBin> bins;
  int64_t cost = 0;         // of the bins
  int64_t lower_bound = 0;  // no packing costs less
  bool optimal = false;     // cost is proven least
};

// Packs all items. Every size is > 0 and fits the largest bin; there is at least one bin type.
// `search_steps` bounds the work (a step is a size tried at one place; about 10 ns to 100 ns). The
// same input gives the same packing everywhere.
Packing PackBins(const std::vector<int64_t>& sizes, const std::vector<BinType>& types,
                 int64_t search_steps);

// Martello and Toth's bound L2 on the number of bins of one capacity; `sizes` descending, each
// `counts[i]` times.
int64_t PackingBound(const std::vector<int64_t>& sizes, const std::vector<int>& counts,
                     int64_t capacity);

}  // namespace mortise::fabplanner
