#include "services/retrieval/service/match_designs.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

constexpr int kMostDesigns = 1'000;  // that are made for one search
constexpr int kAtOnce = 20;          // matches that are asked for first, where more may be needed

// Whether the design that a match stands for meets the filter.
absl::StatusOr<bool> MeetsFilter(const DesignFilter& filter, const IndexMatch& match,
                                 const LoadedIndex& index, TemplateSource& templates,
                                 const rpc::Origin& origin) {
  const absl::StatusOr<MatchDesign> made = DesignOf(match, index, templates, origin);
  if (made.ok()) return Meets(filter, made->design, made->compiled->function->head().items);
  if (IsPassingFailure(made.status())) return made.status();
  return false;
}

}  // namespace

absl::StatusOr<MatchDesign> DesignOf(const IndexMatch& match, const LoadedIndex& index,
                                     TemplateSource& templates, const rpc::Origin& origin) {
  const v1::ShapeIndex::Family& family = index.record.families(match.family);
  MatchDesign made;
  MORTISE_ASSIGN_OR_RETURN(
      made.compiled,
      templates.Get(family.template_(), family.template_revision(), origin, family.group()));
  MORTISE_ASSIGN_OR_RETURN(made.design, made.compiled->function->Evaluate(
                                            index.primitives.PrimitiveOf(match).parameters));
  return made;
}

absl::StatusOr<FoundMatches> NearestThatMeet(const DesignFilter& filter, IndexQuery query,
                                             const LoadedIndex& index, TemplateSource& templates,
                                             const rpc::Origin& origin,
                                             const std::function<bool()>& stopped) {
  FoundMatches found;
  if (IsEmpty(filter)) {
    MORTISE_ASSIGN_OR_RETURN(found.matches, index.primitives.Nearest(query));
    return found;
  }
  // Families that were looked at are the nearest ones: without them, the next are found.
  std::set<int> seen;
  const auto wanted = static_cast<std::size_t>(query.count);
  query.allowed = [&seen, may = std::move(query.allowed)](int family) {
    return !seen.contains(family) && (!may || may(family));
  };
  for (query.count = std::max(query.count, kAtOnce);; query.count *= 2) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<IndexMatch> next, index.primitives.Nearest(query));
    for (const IndexMatch& match : next) {
      if (stopped()) return absl::CancelledError("nobody waits for the answer any more");
      if (static_cast<int>(seen.size()) == kMostDesigns) {
        found.all_looked_at = false;
        return found;
      }
      seen.insert(match.family);
      MORTISE_ASSIGN_OR_RETURN(const bool meets,
                               MeetsFilter(filter, match, index, templates, origin));
      if (meets) found.matches.push_back(match);
      if (found.matches.size() == wanted) return found;
    }
    if (static_cast<int>(next.size()) < query.count) return found;
  }
}

}  // namespace mortise::retrieval
