// Materials in the store.
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/template_codec.h"
#include "common/resources/resource_filter.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/list_filter.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_page.h"
#include "services/catalog/records/row_records.h"

namespace mortise::catalog {
namespace {

constexpr RowKind kRows = {.names = kMaterials, .name = "material"};

// Materials stand for themselves.
absl::Status CheckWhole(store::ReadTransaction&, const v1::Material& material) {
  return CheckMaterial(material);
}

// Whether the material gives way as is asked for.
bool HasElasticity(const v1::Material& material, v1::ListMaterialsRequest::Elasticity elasticity) {
  switch (elasticity) {
    case v1::ListMaterialsRequest::ISOTROPIC:
      return !material.has_orthotropic();
    case v1::ListMaterialsRequest::ORTHOTROPIC:
      return material.has_orthotropic();
    default:
      return true;
  }
}

// Names of items made of the material, a few at most.
absl::StatusOr<std::vector<std::string>> ItemsOf(store::ReadTransaction& transaction,
                                                 const std::string& material) {
  v1::ListItemsRequest request;
  request.set_material(material);
  request.set_page_size(5);
  MORTISE_ASSIGN_OR_RETURN(const Page<v1::Item> page, ListItems(transaction, request));
  std::vector<std::string> names;
  for (const v1::Item& item : page.entries) names.push_back(item.name());
  return names;
}

}  // namespace

absl::StatusOr<v1::Material> GetMaterial(store::ReadTransaction& transaction,
                                         const std::string& name, int64_t revision) {
  return GetRow<v1::Material>(transaction, kRows, name, revision);
}

absl::StatusOr<Page<v1::Material>> ListMaterials(store::ReadTransaction& transaction,
                                                 const v1::ListMaterialsRequest& request) {
  const absl::StatusOr<WordFilter> words = WordFilter::Create(request.text());
  const auto filter = resources::ResourceFilter::Of(request);
  MORTISE_RETURN_IF_ERROR(CombineViolations(CombineViolations(words.status(), filter.status()),
                                            resources::ReadPageQuery(request).status()));
  return ReadPage<v1::Material>(
      transaction, kMaterials, request,
      [&](const store::Record& record) -> absl::StatusOr<std::optional<v1::Material>> {
        MORTISE_ASSIGN_OR_RETURN(v1::Material material, RowOf<v1::Material>(kRows, record));
        if (!HasElasticity(material, request.elasticity()) || !filter->Matches(material)) {
          return std::nullopt;
        }
        if (!words->Matches(material.name(), {material.title()})) return std::nullopt;
        return material;
      });
}

absl::Status CheckMaterial(const v1::Material& material) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Material converted, parametric::FromProto(material));
  return CombineViolations(parametric::ToStatus(parametric::ValidateMaterial(converted)),
                           resources::ValidateTags(material));
}

absl::StatusOr<v1::Material> CreateMaterial(store::Transaction& transaction,
                                            const v1::Material& material,
                                            const resources::Author& author) {
  return CreateRow(transaction, kRows, material, CheckWhole, author);
}

absl::StatusOr<v1::Material> UpdateMaterial(store::Transaction& transaction,
                                            const v1::UpdateMaterialRequest& request,
                                            const resources::Author& author) {
  return UpdateRow(transaction, kRows, request.material(), request.update_mask(), CheckWhole,
                   author);
}

absl::StatusOr<Replacement> ReplaceMaterial(store::Transaction& transaction,
                                            const v1::Material& material,
                                            const resources::Author& author) {
  return ReplaceRow(transaction, kRows, material, author);
}

absl::Status DeleteMaterial(store::Transaction& transaction,
                            const v1::DeleteMaterialRequest& request,
                            const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Material present, GetMaterial(transaction, request.name()));
  if (present.revision() != request.revision()) {
    return StaleRevision(present.name(), request.revision(), present.revision());
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<std::string> items,
                           ItemsOf(transaction, present.name()));
  if (!items.empty()) {
    return PreconditionFailed(
        "MATERIAL_IN_USE",
        "'" + present.name() + "' is what items are made of: " + absl::StrJoin(items, ", "),
        "name");
  }
  const std::string id = present.name().substr(std::string(kMaterials).size() + 1);
  MORTISE_RETURN_IF_ERROR(transaction.Delete(kMaterials, id, present.revision()));
  return AppendEvent(transaction, "material.deleted", present.name(),
                     {{"revision", present.revision()}}, author);
}

}  // namespace mortise::catalog
