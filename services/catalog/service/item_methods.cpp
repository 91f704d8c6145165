#include "services/catalog/service/item_methods.h"

#include <utility>

#include "common/base/errors.h"
#include "common/host/call_author.h"
#include "common/resources/collection.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::Item> GetItem(Catalog& catalog, const rpc::Call&,
                                 const v1::GetItemRequest& asked) {
  return resources::ReadFrom<v1::Item>(*catalog.store, [&](store::ReadTransaction& transaction) {
    return OrNearName(transaction, kItems, asked.name(),
                      catalog::GetItem(transaction, asked.name(), asked.revision()));
  });
}

absl::StatusOr<v1::ListItemsResponse> ListItems(Catalog& catalog, const rpc::Call&,
                                                const v1::ListItemsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(
      Page<v1::Item> page,
      resources::ReadFrom<Page<v1::Item>>(*catalog.store, [&](store::ReadTransaction& transaction) {
        return catalog::ListItems(transaction, asked);
      }));
  return resources::ToResponse(std::move(page), &v1::ListItemsResponse::mutable_items);
}

absl::StatusOr<v1::Item> CreateItem(const rpc::Call& call, const v1::CreateItemRequest& asked,
                                    store::Transaction& transaction) {
  return catalog::CreateItem(transaction, asked.item(), rpc::AuthorOf(call));
}

absl::StatusOr<v1::Item> UpdateItem(const rpc::Call& call, const v1::UpdateItemRequest& asked,
                                    store::Transaction& transaction) {
  return catalog::UpdateItem(transaction, asked, rpc::AuthorOf(call));
}

absl::StatusOr<v1::DeleteItemResponse> DeleteItem(const rpc::Call& call,
                                                  const v1::DeleteItemRequest& asked,
                                                  store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(catalog::DeleteItem(transaction, asked, rpc::AuthorOf(call)));
  return v1::DeleteItemResponse();
}

}  // namespace mortise::catalog::methods
