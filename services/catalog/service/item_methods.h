// Methods of CatalogService about items; catalog.proto says what each does.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::Item> GetItem(Catalog& catalog, const rpc::Call& call,
                                 const v1::GetItemRequest& asked);
absl::StatusOr<v1::ListItemsResponse> ListItems(Catalog& catalog, const rpc::Call& call,
                                                const v1::ListItemsRequest& asked);
absl::StatusOr<v1::Item> CreateItem(const rpc::Call& call, const v1::CreateItemRequest& asked,
                                    store::Transaction& transaction);
absl::StatusOr<v1::Item> UpdateItem(const rpc::Call& call, const v1::UpdateItemRequest& asked,
                                    store::Transaction& transaction);
absl::StatusOr<v1::DeleteItemResponse> DeleteItem(const rpc::Call& call,
                                                  const v1::DeleteItemRequest& asked,
                                                  store::Transaction& transaction);

}  // namespace mortise::catalog::methods
