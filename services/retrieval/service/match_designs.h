// The designs that matches stand for, and which matches are those of designs that meet a filter.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/design/evaluated_design.h"
#include "common/rpc/call.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/filters/design_filter.h"
#include "services/retrieval/filters/filtered_search.h"
#include "services/retrieval/index/primitive_index.h"
#include "services/retrieval/service/loaded_indexes.h"

namespace mortise::retrieval {

// A design as its template makes it.
struct MatchDesign {
  std::shared_ptr<const SearchedTemplate> compiled;
  parametric::EvaluatedDesign design;
};

// Returns the design of a family at the parameters of a match. Fails as TemplateSource::Get and
// templates::Template::Evaluate.
absl::StatusOr<MatchDesign> DesignOf(const IndexMatch& match, const LoadedIndex& index,
                                     TemplateSource& templates, const rpc::Origin& origin);

// What filters look at of the designs of matches. These are kept, as a design may take a second to
// make: a search that has no time for all of them, asked again, goes on where it ended. Thread
// safe.
class MatchFacts {
 public:
  // `templates` outlives it. `capacity`: bytes of what is kept, the least recently used forgotten
  // first.
  explicit MatchFacts(TemplateSource* templates, std::size_t capacity = std::size_t{32} << 20)
      : templates_(*templates), kept_(capacity) {}

  // A design that can no more be made has no parts. Fails as IsPassingFailure alone.
  absl::StatusOr<std::shared_ptr<const DesignFacts>> Get(const IndexMatch& match,
                                                         const LoadedIndex& index,
                                                         const rpc::Origin& origin);

 private:
  TemplateSource& templates_;
  SingleFlightCache<std::shared_ptr<const DesignFacts>> kept_;
};

// How many of the designs that were looked at meet each part of a filter, and the nearest of those
// that lack nothing but items.
struct FilterTally {
  int of_size = 0;
  int of_materials = 0;
  int of_price = 0;
  int of_items = 0;
  std::string lacking_template = {};  // templates/{id}; empty where there is none
  std::vector<LackingItem> lacking = {};
};

// As NearestThatMeet of filtered_search.h, with what it looked at counted in `tally`. It ends early
// once the designs have taken 20 s, or half of the time that the caller still waits, as pictures
// and fits are to come. CANCELLED once nobody waits for the answer; UNAVAILABLE where the catalog
// is.
absl::StatusOr<FilteredMatches> NearestThatMeet(const DesignFilter& filter, IndexQuery query,
                                                const LoadedIndex& index, MatchFacts& facts,
                                                const rpc::Call& call, FilterTally* tally);

}  // namespace mortise::retrieval
