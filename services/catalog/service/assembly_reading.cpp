#include "services/catalog/service/assembly_reading.h"

#include <utility>

#include "common/base/errors.h"
#include "common/files/template_codec.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {

absl::StatusOr<v1::AssemblyBundle> FindAssembly(const Catalog& catalog, const std::string& name,
                                                int64_t revision) {
  return resources::ReadFrom<v1::AssemblyBundle>(
      *catalog.store, [&](store::ReadTransaction& transaction) {
        return OrNearName(transaction, kAssemblies, name,
                          GetAssemblyBundle(transaction, name, revision));
      });
}

absl::StatusOr<ParametrizedAssembly> FindParametrized(Catalog& catalog, const rpc::Call& call,
                                                      const std::string& name, int64_t revision) {
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, FindAssembly(catalog, name, revision));
  const auto add_shapes = [&catalog](v1::AssemblyBundle& needed) {
    return catalog.store->Read([&](store::ReadTransaction& transaction) {
      return AddShapes(transaction, needed.assembly(), needed.items(), *needed.mutable_shapes());
    });
  };
  MORTISE_ASSIGN_OR_RETURN(templates::Parametrization parametrized,
                           catalog.parametrized.Get(
                               bundle, [&call] { return call.cancelled(); }, add_shapes));
  return ParametrizedAssembly{std::move(bundle), std::move(parametrized)};
}

absl::StatusOr<parametric::TemplateBundle> UsedBy(const v1::AssemblyBundle& bundle) {
  parametric::TemplateBundle used;
  for (const v1::Item& message : bundle.items()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
    used.items.push_back(std::move(item));
  }
  for (const v1::Material& message : bundle.materials()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Material material, parametric::FromProto(message));
    used.materials.push_back(std::move(material));
  }
  return used;
}

}  // namespace mortise::catalog
