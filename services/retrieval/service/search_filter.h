// Which templates, and which of their designs, a search may find.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "absl/status/statusor.h"
#include "common/resources/resource_filter.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/filters/design_filter.h"

namespace mortise::retrieval {

struct SearchFilter {
  // What an index says of a family suffices to tell whether it meets these.
  std::optional<std::set<std::string>> templates = {};  // by name
  std::optional<resources::ResourceFilter> resources = {};
  std::set<std::string> categories = {};  // any if empty
  // What only a design itself tells.
  DesignFilter design = {};
};

// The label of templates whose values are categories.
inline constexpr char kCategoryLabel[] = "category";

// Returns what a request filters by. INVALID_ARGUMENT naming each of "templates[0]",
// "filter.labels", "categories", "design_filter.max_size.x" and so on that is at fault.
absl::StatusOr<SearchFilter> ReadSearchFilter(const v1::SearchShapesRequest& request);

// Whether a family of an index may be found, as far as can be told without making designs of it.
bool MayBeFound(const SearchFilter& filter, const v1::ShapeIndex::Family& family);

}  // namespace mortise::retrieval
