// The designs that matches stand for, and those of them that meet a filter.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/rpc/channel.h"
#include "services/retrieval/filters/design_filter.h"
#include "services/retrieval/index/primitive_index.h"
#include "services/retrieval/service/loaded_indexes.h"
#include "services/retrieval/service/template_source.h"

namespace mortise::retrieval {

// A design as its template makes it.
struct MatchDesign {
  std::shared_ptr<const CompiledTemplate> compiled;
  parametric::EvaluatedDesign design;
};

// The design of a family at the parameters of a match. Fails as TemplateSource::Get and
// templates::Template::Evaluate.
absl::StatusOr<MatchDesign> DesignOf(const IndexMatch& match, const LoadedIndex& index,
                                     TemplateSource& templates, const rpc::Origin& origin);

struct FoundMatches {
  std::vector<IndexMatch> matches;  // nearest first
  bool all_looked_at = true;        // whether none was left out because so many did not meet it
};

// The nearest families whose designs meet the filter: what is left of the list of all that `query`
// allows, nearest first, each with the design of its nearest primitive, `query.count` at most.
// Designs are made in that order, until there are enough; of the first thousand at most. A design
// that can no more be made meets no filter. CANCELLED once `stopped` says so; fails as
// PrimitiveIndex::Nearest, and UNAVAILABLE where the catalog is.
absl::StatusOr<FoundMatches> NearestThatMeet(const DesignFilter& filter, IndexQuery query,
                                             const LoadedIndex& index, TemplateSource& templates,
                                             const rpc::Origin& origin,
                                             const std::function<bool()>& stopped);

}  // namespace mortise::retrieval
