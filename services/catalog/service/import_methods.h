// Methods of CatalogService that bring many things in at once; catalog.proto says what each does.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

// Checks all of an import, which tries designs of templates, before the transaction of
// ImportCatalog.
absl::StatusOr<std::vector<v1::TemplateBundle>> PrepareCatalog(
    Catalog& catalog, const rpc::Call& call, const v1::ImportCatalogRequest& asked);
absl::StatusOr<v1::ImportCatalogResponse> ImportCatalog(const rpc::Call& call,
                                                        const v1::ImportCatalogRequest& asked,
                                                        std::vector<v1::TemplateBundle>& templates,
                                                        store::Transaction& transaction);

}  // namespace mortise::catalog::methods
