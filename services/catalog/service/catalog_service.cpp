// The methods of CatalogService, one a line. What answers them is in <resource>_methods.cpp.
#include "services/catalog/service/catalog_service.h"

#include <utility>

#include "common/base/errors.h"
#include "common/rpc/method_overrides.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/catalog/records/upkeep.h"
#include "services/catalog/service/assembly_service.h"
#include "services/catalog/service/catalog.h"
#include "services/catalog/service/collection_loader.h"
#include "services/catalog/service/design_methods.h"
#include "services/catalog/service/import_methods.h"
#include "services/catalog/service/item_methods.h"
#include "services/catalog/service/material_methods.h"
#include "services/catalog/service/shape_methods.h"
#include "services/catalog/service/template_methods.h"

namespace mortise::catalog {
namespace {

using rpc::BadNumbers;
using rpc::With;

class CatalogAdapter final : public v1::CatalogService::CallbackService {
  using Contract = v1::CatalogService::CallbackService;

 public:
  CatalogAdapter(const rpc::ServiceEnvironment& environment, std::shared_ptr<Catalog> catalog)
      : catalog_(std::move(catalog)),
        endpoint_(environment.dispatcher, "mortise.v1.CatalogService"),
        upkeep_(catalog_->store, catalog_->blobs, environment.options.blobs) {}

  MORTISE_PREPARED_MUTATION(ImportCatalog, With(*catalog_, methods::PrepareCatalog),
                            methods::ImportCatalog, BadNumbers::kToldWithAllElse)

  MORTISE_QUERY(GetMaterial, With(*catalog_, methods::GetMaterial))
  MORTISE_QUERY(ListMaterials, With(*catalog_, methods::ListMaterials))
  MORTISE_MUTATION(CreateMaterial, methods::CreateMaterial)
  MORTISE_MUTATION(UpdateMaterial, methods::UpdateMaterial)
  MORTISE_MUTATION(DeleteMaterial, methods::DeleteMaterial)

  MORTISE_QUERY(GetItem, With(*catalog_, methods::GetItem))
  MORTISE_QUERY(ListItems, With(*catalog_, methods::ListItems))
  MORTISE_MUTATION(CreateItem, methods::CreateItem)
  MORTISE_MUTATION(UpdateItem, methods::UpdateItem)
  MORTISE_MUTATION(DeleteItem, methods::DeleteItem)

  MORTISE_PREPARED_MUTATION(ImportShape, methods::PrepareShape, methods::ImportShape)
  MORTISE_QUERY(GetShape, With(*catalog_, methods::GetShape))
  MORTISE_SERVER_STREAM(DownloadShape, With(*catalog_, methods::DownloadShape))

  MORTISE_QUERY(GetTemplate, With(*catalog_, methods::GetTemplate))
  MORTISE_QUERY(ListTemplates, With(*catalog_, methods::ListTemplates))
  MORTISE_PREPARED_MUTATION(ImportTemplate, With(*catalog_, methods::PrepareTemplate),
                            methods::ImportTemplate, BadNumbers::kToldWithAllElse)
  MORTISE_PREPARED_MUTATION(PlaceTemplate, With(*catalog_, methods::PreparePlacing),
                            methods::PlaceTemplate, BadNumbers::kToldWithAllElse)
  MORTISE_MUTATION(DeleteTemplate, methods::DeleteTemplate)
  MORTISE_QUERY(GetTemplateBundle, With(*catalog_, methods::GetTemplateBundle))

  MORTISE_QUERY(EvaluateTemplate, With(*catalog_, methods::EvaluateTemplate),
                With(*catalog_, methods::ExplainEvaluateTemplate))
  MORTISE_SERVER_STREAM(ExportDesign, With(*catalog_, methods::ExportDesign), {},
                        With(*catalog_, methods::ExplainExportDesign))

 private:
  const std::shared_ptr<Catalog> catalog_;
  rpc::Endpoint endpoint_;
  const Upkeep upkeep_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, const std::filesystem::path& collection) {
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder* const blobs, environment.store->Blobs());
  const auto catalog = std::make_shared<Catalog>(environment.store, blobs);
  if (!collection.empty()) {
    MORTISE_RETURN_IF_ERROR(
        LoadCollection(*environment.store, collection, catalog->parametrized).status());
    catalog->parametrized.KeepWhatWasFound();
  }
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<CatalogAdapter>(environment, catalog),
      MakeAssemblyService(environment, catalog)};
}

}  // namespace mortise::catalog
