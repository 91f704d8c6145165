#include "services/retrieval/filters/filtered_search.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

constexpr int kAtOnce = 20;  // matches that are asked for first, where more may be needed

}  // namespace

absl::StatusOr<FilteredMatches> NearestThatMeet(
    const PrimitiveIndex& index, IndexQuery query,
    const std::function<absl::StatusOr<bool>(const IndexMatch&)>& meets,
    const FilterLimits& limits) {
  FilteredMatches found;
  // Families that were looked at are the nearest ones: without them, the next are found.
  std::set<int> seen;
  const auto wanted = static_cast<std::size_t>(query.count);
  query.allowed = [&seen, may = std::move(query.allowed)](int family) {
    return !seen.contains(family) && (!may || may(family));
  };
  for (query.count = std::max(query.count, kAtOnce);; query.count *= 2) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<IndexMatch> next, index.Nearest(query));
    for (const IndexMatch& match : next) {
      if (found.looked_at == limits.designs || (limits.is_time_up && limits.is_time_up())) {
        found.ended_early = true;
        return found;
      }
      seen.insert(match.family);
      MORTISE_ASSIGN_OR_RETURN(const bool is_met, meets(match));
      ++found.looked_at;
      if (is_met) found.matches.push_back(match);
      if (found.matches.size() == wanted) return found;
    }
    if (static_cast<int>(next.size()) < query.count) return found;
  }
}

}  // namespace mortise::retrieval
