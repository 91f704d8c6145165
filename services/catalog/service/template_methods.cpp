#include "services/catalog/service/template_methods.h"

#include <utility>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/resources/collection.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/service/template_placing.h"
#include "services/catalog/service/template_reading.h"

namespace mortise::catalog::methods {
namespace {

absl::StatusOr<v1::TemplateBundle> FreezeAndComplete(Catalog& catalog, const rpc::Call& call,
                                                     const v1::Template& message) {
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                           resources::ReadFrom<v1::TemplateBundle>(
                               *catalog.store, [&](store::ReadTransaction& transaction) {
                                 return Freeze(transaction, message);
                               }));
  const absl::Status faults = templates::FillAndCheck(
      bundle, templates::Trial::kThorough, [&call] { return call.cancelled(); },
      catalog.parametrized.ForTemplates());
  if (faults.ok()) return bundle;
  return catalog.store->Read([&](store::ReadTransaction& transaction) {
    return WithNearItems(transaction, templates::ItemsOf(message), faults);
  });
}

}  // namespace

absl::StatusOr<v1::Template> GetTemplate(Catalog& catalog, const rpc::Call&,
                                         const v1::GetTemplateRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                           FindBundle(catalog, asked.name(), asked.revision()));
  return std::move(*bundle.mutable_template_());
}

absl::StatusOr<v1::ListTemplatesResponse> ListTemplates(Catalog& catalog, const rpc::Call&,
                                                        const v1::ListTemplatesRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(Page<v1::Template> page,
                           resources::ReadFrom<Page<v1::Template>>(
                               *catalog.store, [&](store::ReadTransaction& transaction) {
                                 return catalog::ListTemplates(transaction, asked);
                               }));
  return resources::ToResponse(std::move(page), &v1::ListTemplatesResponse::mutable_templates);
}

absl::StatusOr<v1::TemplateBundle> GetTemplateBundle(Catalog& catalog, const rpc::Call&,
                                                     const v1::GetTemplateBundleRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                           FindBundle(catalog, asked.name(), asked.revision()));
  MORTISE_RETURN_IF_ERROR(AddShapesTo(catalog, bundle));
  DropExact(*bundle.mutable_shapes());
  NameWhatDoesNotFit(bundle);
  return bundle;
}

absl::StatusOr<v1::TemplateBundle> PrepareTemplate(Catalog& catalog, const rpc::Call& call,
                                                   const v1::ImportTemplateRequest& asked) {
  const v1::Template& message = asked.template_();
  absl::StatusOr<v1::TemplateBundle> bundle = FreezeAndComplete(catalog, call, message);
  const absl::Status faults = CombineViolations(bundle.status(), resources::ValidateTags(message));
  MORTISE_RETURN_IF_ERROR(WithRevisionFault(*catalog.store, kTemplates, message.name(),
                                            asked.expected_revision(),
                                            UnderField("template", faults)));
  return bundle;
}

absl::StatusOr<v1::Template> ImportTemplate(const rpc::Call& call,
                                            const v1::ImportTemplateRequest& asked,
                                            v1::TemplateBundle& bundle,
                                            store::Transaction& transaction) {
  return ImportBundle(transaction, bundle, asked.expected_revision(), rpc::AuthorOf(call));
}

absl::StatusOr<v1::TemplateBundle> PreparePlacing(Catalog& catalog, const rpc::Call& call,
                                                  const v1::PlaceTemplateRequest& asked) {
  const absl::Status tags = resources::ValidateTags(asked);
  absl::StatusOr<v1::TemplateBundle> bundle =
      PlaceOn(catalog, asked, [&call] { return call.cancelled(); });
  MORTISE_RETURN_IF_ERROR(CombineViolations(bundle.status(), tags));
  resources::CopyTags(asked, bundle->mutable_template_());
  return bundle;
}

absl::StatusOr<v1::Template> PlaceTemplate(const rpc::Call& call, const v1::PlaceTemplateRequest&,
                                           v1::TemplateBundle& bundle,
                                           store::Transaction& transaction) {
  return PutPlaced(transaction, bundle, rpc::AuthorOf(call));
}

absl::StatusOr<v1::DeleteTemplateResponse> DeleteTemplate(const rpc::Call& call,
                                                          const v1::DeleteTemplateRequest& asked,
                                                          store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(catalog::DeleteTemplate(transaction, asked, rpc::AuthorOf(call)));
  return v1::DeleteTemplateResponse();
}

}  // namespace mortise::catalog::methods
