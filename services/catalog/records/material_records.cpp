// Materials in the store.
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/template_codec.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/list_filter.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_page.h"
#include "services/catalog/records/record_update.h"

namespace mortise::catalog {
namespace {

absl::StatusOr<v1::Material> MaterialOf(const store::Record& record) {
  v1::Material material;
  if (!material.ParseFromString(record.payload)) {
    return StorageFailed("materials/" + record.key, "the record cannot be read");
  }
  material.set_revision(record.revision);
  return material;
}

// The revision is the record's, not the payload's.
std::string PayloadOf(v1::Material material) {
  material.clear_revision();
  return material.SerializeAsString();
}

// Writes a material as the revision after `present`, 0 for a new one, and tells of it.
absl::StatusOr<int64_t> Write(store::Transaction& transaction, const v1::Material& material,
                              int64_t present, const std::string& trace_id) {
  MORTISE_ASSIGN_OR_RETURN(
      const int64_t revision,
      present == 0
          ? PutNew(transaction, kMaterials, material.name(), PayloadOf(material))
          : PutNext(transaction, kMaterials, material.name(), PayloadOf(material), present));
  MORTISE_RETURN_IF_ERROR(AppendEvent(
      transaction, present == 0 ? "material.created" : "material.updated", material.name(),
      {{"title", material.title()}, {"revision", revision}}, trace_id));
  return revision;
}

// Whether the material gives way as is asked for.
bool Gives(const v1::Material& material, v1::ListMaterialsRequest::Elasticity elasticity) {
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
  MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                           GetRecord(transaction, kMaterials, name, revision));
  return MaterialOf(record);
}

absl::StatusOr<Page<v1::Material>> ListMaterials(store::ReadTransaction& transaction,
                                                 const v1::ListMaterialsRequest& request) {
  const absl::StatusOr<WordFilter> words = WordFilter::Create(request.text());
  MORTISE_RETURN_IF_ERROR(Together(words.status(), resources::ReadPageQuery(request).status()));
  return ReadPage<v1::Material>(
      transaction, kMaterials, request,
      [&](const store::Record& record) -> absl::StatusOr<std::optional<v1::Material>> {
        MORTISE_ASSIGN_OR_RETURN(v1::Material material, MaterialOf(record));
        if (!Gives(material, request.elasticity())) return std::nullopt;
        if (!words->Takes(material.name(), {material.title()})) return std::nullopt;
        return material;
      });
}

absl::Status CheckMaterial(const v1::Material& material) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Material converted, parametric::FromProto(material));
  return parametric::ToStatus(parametric::ValidateMaterial(converted));
}

absl::StatusOr<v1::Material> CreateMaterial(store::Transaction& transaction,
                                            const v1::Material& material,
                                            const std::string& trace_id) {
  MORTISE_RETURN_IF_ERROR(UnderField("material", CheckMaterial(material)));
  MORTISE_RETURN_IF_ERROR(Write(transaction, material, 0, trace_id).status());
  return GetMaterial(transaction, material.name());
}

absl::StatusOr<v1::Material> UpdateMaterial(store::Transaction& transaction,
                                            const v1::UpdateMaterialRequest& request,
                                            const std::string& trace_id) {
  MORTISE_RETURN_IF_ERROR(CheckUpdateMask<v1::Material>(request.update_mask()));
  absl::StatusOr<v1::Material> present = GetMaterial(transaction, request.material().name());
  if (absl::IsInvalidArgument(present.status())) return UnderField("material", present.status());
  MORTISE_RETURN_IF_ERROR(present.status());
  if (present->revision() != request.material().revision()) {
    return StaleRevision(present->name(), request.material().revision(), present->revision());
  }
  const v1::Material changed = Updated(*present, request.material(), request.update_mask());
  MORTISE_RETURN_IF_ERROR(UnderField("material", CheckMaterial(changed)));
  MORTISE_RETURN_IF_ERROR(Write(transaction, changed, present->revision(), trace_id).status());
  return GetMaterial(transaction, changed.name());
}

absl::StatusOr<Replacement> ReplaceMaterial(store::Transaction& transaction,
                                            const v1::Material& material,
                                            const std::string& trace_id) {
  absl::StatusOr<v1::Material> present = GetMaterial(transaction, material.name());
  if (!absl::IsNotFound(present.status())) MORTISE_RETURN_IF_ERROR(present.status());
  Replacement replaced{.before = present.ok() ? present->revision() : 0};
  replaced.revision = replaced.before;
  if (present.ok() && PayloadOf(*present) == PayloadOf(material)) return replaced;
  MORTISE_ASSIGN_OR_RETURN(replaced.revision,
                           Write(transaction, material, replaced.before, trace_id));
  return replaced;
}

absl::Status DeleteMaterial(store::Transaction& transaction,
                            const v1::DeleteMaterialRequest& request, const std::string& trace_id) {
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
                     {{"revision", present.revision()}}, trace_id);
}

}  // namespace mortise::catalog
