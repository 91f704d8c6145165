#include "services/catalog/service/import_methods.h"

#include "common/host/call_author.h"
#include "services/catalog/service/catalog_import.h"

namespace mortise::catalog::methods {

absl::StatusOr<std::vector<v1::TemplateBundle>> PrepareCatalog(
    Catalog& catalog, const rpc::Call& call, const v1::ImportCatalogRequest& asked) {
  return PrepareImport(
      *catalog.store, asked, [&call] { return call.cancelled(); },
      catalog.parametrized.ForTemplates());
}

absl::StatusOr<v1::ImportCatalogResponse> ImportCatalog(const rpc::Call& call,
                                                        const v1::ImportCatalogRequest& asked,
                                                        std::vector<v1::TemplateBundle>& templates,
                                                        store::Transaction& transaction) {
  return catalog::ImportCatalog(transaction, asked, templates, rpc::AuthorOf(call));
}

}  // namespace mortise::catalog::methods
