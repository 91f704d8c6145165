#include "services/catalog/service/material_methods.h"

#include <utility>

#include "common/base/errors.h"
#include "common/host/call_author.h"
#include "common/resources/collection.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::Material> GetMaterial(Catalog& catalog, const rpc::Call&,
                                         const v1::GetMaterialRequest& asked) {
  return resources::ReadFrom<v1::Material>(
      *catalog.store, [&](store::ReadTransaction& transaction) {
        return OrNearName(transaction, kMaterials, asked.name(),
                          catalog::GetMaterial(transaction, asked.name(), asked.revision()));
      });
}

absl::StatusOr<v1::ListMaterialsResponse> ListMaterials(Catalog& catalog, const rpc::Call&,
                                                        const v1::ListMaterialsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(Page<v1::Material> page,
                           resources::ReadFrom<Page<v1::Material>>(
                               *catalog.store, [&](store::ReadTransaction& transaction) {
                                 return catalog::ListMaterials(transaction, asked);
                               }));
  return resources::ToResponse(std::move(page), &v1::ListMaterialsResponse::mutable_materials);
}

absl::StatusOr<v1::Material> CreateMaterial(const rpc::Call& call,
                                            const v1::CreateMaterialRequest& asked,
                                            store::Transaction& transaction) {
  return catalog::CreateMaterial(transaction, asked.material(), rpc::AuthorOf(call));
}

absl::StatusOr<v1::Material> UpdateMaterial(const rpc::Call& call,
                                            const v1::UpdateMaterialRequest& asked,
                                            store::Transaction& transaction) {
  return catalog::UpdateMaterial(transaction, asked, rpc::AuthorOf(call));
}

absl::StatusOr<v1::DeleteMaterialResponse> DeleteMaterial(const rpc::Call& call,
                                                          const v1::DeleteMaterialRequest& asked,
                                                          store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(catalog::DeleteMaterial(transaction, asked, rpc::AuthorOf(call)));
  return v1::DeleteMaterialResponse();
}

}  // namespace mortise::catalog::methods
