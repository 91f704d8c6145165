// Which items a List request asks for: those of a kind, of a material, with words in their texts.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

class ItemFilter {
 public:
  // INVALID_ARGUMENT naming "material" if there is no such material, or "text" if it is too long.
  static absl::StatusOr<ItemFilter> Create(store::ReadTransaction& transaction,
                                           const v1::ListItemsRequest& request);

  bool Takes(const v1::Item& item) const;

 private:
  v1::ItemKind kind_ = v1::ITEM_KIND_UNSPECIFIED;
  std::string material_;
  std::vector<std::string> words_;  // in lower case
};

}  // namespace mortise::catalog
