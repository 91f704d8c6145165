// What a search filters by: whether there is what it names, and why nothing is left.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/service/match_designs.h"
#include "services/retrieval/service/search_filter.h"

namespace mortise::retrieval {

// Whether there are the templates, categories, materials and items that a search names. The catalog
// is asked only about those that the index does not know. INVALID_ARGUMENT naming each field at
// fault, such as "categories[0]", with names that are like it; UNAVAILABLE and the like where the
// catalog cannot be asked.
absl::Status CheckFilterNames(const v1::SearchShapesRequest& request, const v1::ShapeIndex& index,
                              const TemplateSource& templates, const rpc::Origin& origin);

// Returns which part of the filter leaves how many, for a search that has found nothing: a sentence
// or two for people. `looked_at`: designs that `tally` counts.
std::string WhyNothingIsFound(const SearchFilter& filter, const v1::ShapeIndex& index,
                              const FilterTally& tally, int looked_at);

}  // namespace mortise::retrieval
