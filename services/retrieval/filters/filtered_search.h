// Searches an index for what it does not know: families whose nearest designs meet something that
// only a design tells, and that may take long to find out.
#pragma once

#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval {

// Where such a search ends without having looked at all.
struct FilterLimits {
  int designs = 1'000;  // that are looked at, at most
  // Asked before each design; true once there is no time for more. There always is without.
  std::function<bool()> is_time_up = nullptr;
};

struct FilteredMatches {
  std::vector<IndexMatch> matches;  // nearest first
  int looked_at = 0;                // designs
  // Whether a limit ended it: families that are further away may meet what was asked, too.
  bool ended_early = false;
};

// Returns the nearest families whose designs meet what is asked: what is left of the list of all
// that `query` allows, nearest first, each with the design of its nearest primitive, `query.count`
// at most. `meets` is asked in that order, until there are enough or a limit ends it; its first
// failure is the search's. Fails as PrimitiveIndex::Nearest, too.
absl::StatusOr<FilteredMatches> NearestThatMeet(
    const PrimitiveIndex& index, IndexQuery query,
    const std::function<absl::StatusOr<bool>(const IndexMatch&)>& meets,
    const FilterLimits& limits = {});

}  // namespace mortise::retrieval
