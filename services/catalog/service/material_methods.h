// Methods of CatalogService about materials; catalog.proto says what each does.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::Material> GetMaterial(Catalog& catalog, const rpc::Call& call,
                                         const v1::GetMaterialRequest& asked);
absl::StatusOr<v1::ListMaterialsResponse> ListMaterials(Catalog& catalog, const rpc::Call& call,
                                                        const v1::ListMaterialsRequest& asked);
absl::StatusOr<v1::Material> CreateMaterial(const rpc::Call& call,
                                            const v1::CreateMaterialRequest& asked,
                                            store::Transaction& transaction);
absl::StatusOr<v1::Material> UpdateMaterial(const rpc::Call& call,
                                            const v1::UpdateMaterialRequest& asked,
                                            store::Transaction& transaction);
absl::StatusOr<v1::DeleteMaterialResponse> DeleteMaterial(const rpc::Call& call,
                                                          const v1::DeleteMaterialRequest& asked,
                                                          store::Transaction& transaction);

}  // namespace mortise::catalog::methods
