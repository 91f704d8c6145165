// Which items a List request asks for: those of a kind, of a material, with words in their texts.
#pragma once

#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/records/list_filter.h"

namespace mortise::catalog {

class ItemFilter {
 public:
  // INVALID_ARGUMENT naming "material" if there is no such material, or "text" if it is too long.
  static absl::StatusOr<ItemFilter> Create(store::ReadTransaction& transaction,
                                           const v1::ListItemsRequest& request);

  bool Takes(const v1::Item& item) const;

 private:
  explicit ItemFilter(WordFilter words) : words_(std::move(words)) {}

  v1::ItemKind kind_ = v1::ITEM_KIND_UNSPECIFIED;
  std::string material_;
  WordFilter words_;
};

}  // namespace mortise::catalog
