// Methods of CatalogService about templates; catalog.proto says what each does.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::Template> GetTemplate(Catalog& catalog, const rpc::Call& call,
                                         const v1::GetTemplateRequest& asked);
absl::StatusOr<v1::ListTemplatesResponse> ListTemplates(Catalog& catalog, const rpc::Call& call,
                                                        const v1::ListTemplatesRequest& asked);
// With the triangles of all shapes, as many as fit, or their names: what F(q) takes.
absl::StatusOr<v1::TemplateBundle> GetTemplateBundle(Catalog& catalog, const rpc::Call& call,
                                                     const v1::GetTemplateBundleRequest& asked);

// Checks a template with all that it uses, which tries many designs, before the transaction of
// ImportTemplate.
absl::StatusOr<v1::TemplateBundle> PrepareTemplate(Catalog& catalog, const rpc::Call& call,
                                                   const v1::ImportTemplateRequest& asked);
absl::StatusOr<v1::Template> ImportTemplate(const rpc::Call& call,
                                            const v1::ImportTemplateRequest& asked,
                                            v1::TemplateBundle& bundle,
                                            store::Transaction& transaction);
// Puts a template on ground and checks it as PrepareTemplate does, before the transaction of
// PlaceTemplate.
absl::StatusOr<v1::TemplateBundle> PreparePlacing(Catalog& catalog, const rpc::Call& call,
                                                  const v1::PlaceTemplateRequest& asked);
absl::StatusOr<v1::Template> PlaceTemplate(const rpc::Call& call,
                                           const v1::PlaceTemplateRequest& asked,
                                           v1::TemplateBundle& bundle,
                                           store::Transaction& transaction);
absl::StatusOr<v1::DeleteTemplateResponse> DeleteTemplate(const rpc::Call& call,
                                                          const v1::DeleteTemplateRequest& asked,
                                                          store::Transaction& transaction);

}  // namespace mortise::catalog::methods
