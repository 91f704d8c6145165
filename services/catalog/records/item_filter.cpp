#include "services/catalog/records/item_filter.h"

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {

absl::StatusOr<ItemFilter> ItemFilter::Create(store::ReadTransaction& transaction,
                                              const v1::ListItemsRequest& request) {
  absl::StatusOr<WordFilter> words = WordFilter::Create(request.text());
  absl::StatusOr<resources::ResourceFilter> filter = resources::ResourceFilter::Of(request);
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(CheckFilterName(transaction, kMaterials, request.material(), "material"),
                        words.status()),
      filter.status()));
  ItemFilter items(*std::move(words), *std::move(filter));
  items.kind_ = request.kind();
  items.material_ = request.material();
  return items;
}

bool ItemFilter::Matches(const v1::Item& item) const {
  if (kind_ != v1::ITEM_KIND_UNSPECIFIED && item.kind() != kind_) return false;
  if (!material_.empty() && item.material() != material_) return false;
  return filter_.Matches(item) &&
         words_.Matches(item.name(), {item.title(), item.standard(), item.designation()});
}

}  // namespace mortise::catalog
