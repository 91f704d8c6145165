#include "services/catalog/service/template_reading.h"

#include "common/resources/collection.h"
#include "common/store/store.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {

absl::StatusOr<v1::TemplateBundle> FindBundle(const Catalog& catalog, const std::string& name,
                                              int64_t revision) {
  return resources::ReadFrom<v1::TemplateBundle>(
      *catalog.store, [&](store::ReadTransaction& transaction) {
        return OrNearName(transaction, kTemplates, name, GetBundle(transaction, name, revision));
      });
}

absl::Status AddShapesTo(const Catalog& catalog, v1::TemplateBundle& bundle) {
  return catalog.store->Read([&](store::ReadTransaction& transaction) {
    return AddShapes(transaction, bundle.assembly(), bundle.items(), *bundle.mutable_shapes());
  });
}

}  // namespace mortise::catalog
