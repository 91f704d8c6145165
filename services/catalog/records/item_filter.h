// Which items a List request asks for: those of a kind, of a material, with words in their texts,
// with external ids and labels.
#pragma once

#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "common/resources/resource_filter.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/records/list_filter.h"

namespace mortise::catalog {

class ItemFilter {
 public:
  // INVALID_ARGUMENT naming "material" if there is no such material, "text" if it is too long, and
  // fields of "filter".
  static absl::StatusOr<ItemFilter> Create(store::ReadTransaction& transaction,
                                           const v1::ListItemsRequest& request);

  bool Matches(const v1::Item& item) const;

 private:
  ItemFilter(WordFilter words, resources::ResourceFilter filter)
      : words_(std::move(words)), filter_(std::move(filter)) {}

  v1::ItemKind kind_ = v1::ITEM_KIND_UNSPECIFIED;
  std::string material_;
  WordFilter words_;
  resources::ResourceFilter filter_;
};

}  // namespace mortise::catalog
