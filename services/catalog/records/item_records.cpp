// Items in the store.
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/message_checks.h"
#include "common/files/template_codec.h"
#include "common/resources/resource_tags.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/item_filter.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_page.h"
#include "services/catalog/records/record_users.h"
#include "services/catalog/records/row_records.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

constexpr RowKind kRows = {.names = kItems, .name = "item"};

absl::Status CheckWhole(store::ReadTransaction& transaction, const v1::Item& item) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FieldViolation> findings,
                           CheckItem(transaction, item));
  return parametric::ToStatus(findings);
}

// Names are what people write: one that is malformed counts as one that does not exist.
bool IsMissing(const absl::Status& status) {
  return absl::IsNotFound(status) || absl::IsInvalidArgument(status);
}

}  // namespace

absl::StatusOr<v1::Item> GetItem(store::ReadTransaction& transaction, const std::string& name,
                                 int64_t revision) {
  return GetRow<v1::Item>(transaction, kRows, name, revision);
}

absl::StatusOr<Page<v1::Item>> ListItems(store::ReadTransaction& transaction,
                                         const v1::ListItemsRequest& request) {
  const absl::StatusOr<ItemFilter> filter = ItemFilter::Create(transaction, request);
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(filter.status(), resources::ReadPageQuery(request).status()));
  return ReadPage<v1::Item>(
      transaction, kItems, request,
      [&filter](const store::Record& record) -> absl::StatusOr<std::optional<v1::Item>> {
        MORTISE_ASSIGN_OR_RETURN(v1::Item item, RowOf<v1::Item>(kRows, record));
        if (!filter->Matches(item)) return std::nullopt;
        return item;
      });
}

absl::StatusOr<std::vector<FieldViolation>> CheckItem(store::ReadTransaction& transaction,
                                                      const v1::Item& item) {
  std::vector<parametric::Material> materials;
  absl::StatusOr<v1::Material> material = GetMaterial(transaction, item.material());
  if (material.ok()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Material known, parametric::FromProto(*material));
    materials.push_back(std::move(known));
  } else if (!absl::IsNotFound(material.status()) && !absl::IsInvalidArgument(material.status())) {
    return material.status();
  }
  std::vector<FieldViolation> findings = parametric::ValidateItemMessage(item, materials);
  OfferNearName(transaction, kMaterials, item.material(),
                absl::StrCat("there is no material '", item.material(), "'"), findings);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FieldViolation> of_shape,
                           CheckItemShape(transaction, item));
  findings.insert(findings.end(), of_shape.begin(), of_shape.end());
  const std::vector<FieldViolation> of_tags = resources::CheckTags(item);
  findings.insert(findings.end(), of_tags.begin(), of_tags.end());
  return findings;
}

absl::Status AddItems(store::ReadTransaction& transaction, const std::set<std::string>& names,
                      google::protobuf::RepeatedPtrField<v1::Item>& items,
                      google::protobuf::RepeatedPtrField<v1::Material>& materials) {
  std::set<std::string> material_names;
  for (const std::string& name : names) {
    absl::StatusOr<v1::Item> item = GetItem(transaction, name);
    if (IsMissing(item.status())) continue;
    MORTISE_RETURN_IF_ERROR(item.status());
    material_names.insert(item->material());
    *items.Add() = *std::move(item);
  }
  for (const std::string& name : material_names) {
    absl::StatusOr<v1::Material> material = GetMaterial(transaction, name);
    if (IsMissing(material.status())) continue;
    MORTISE_RETURN_IF_ERROR(material.status());
    *materials.Add() = *std::move(material);
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::Item> CreateItem(store::Transaction& transaction, const v1::Item& item,
                                    const resources::Author& author) {
  return CreateRow(transaction, kRows, item, CheckWhole, author);
}

absl::StatusOr<v1::Item> UpdateItem(store::Transaction& transaction,
                                    const v1::UpdateItemRequest& request,
                                    const resources::Author& author) {
  return UpdateRow(transaction, kRows, request.item(), request.update_mask(), CheckWhole, author);
}

absl::StatusOr<Replacement> ReplaceItem(store::Transaction& transaction, const v1::Item& item,
                                        const resources::Author& author) {
  return ReplaceRow(transaction, kRows, item, author);
}

absl::Status DeleteItem(store::Transaction& transaction, const v1::DeleteItemRequest& request,
                        const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Item present, GetItem(transaction, request.name()));
  if (present.revision() != request.revision()) {
    return StaleRevision(present.name(), request.revision(), present.revision());
  }
  std::vector<std::string> users;
  MORTISE_RETURN_IF_ERROR(AddUsers(
      transaction, kTemplates,
      [&](const store::Record& record) { return Uses<v1::TemplateBundle>(record, present.name()); },
      users));
  MORTISE_RETURN_IF_ERROR(AddUsers(
      transaction, kAssemblies,
      [&](const store::Record& record) { return Uses<v1::AssemblyBundle>(record, present.name()); },
      users));
  if (!users.empty()) {
    return PreconditionFailed(
        "ITEM_IN_USE", "'" + present.name() + "' is used by " + absl::StrJoin(users, ", "), "name");
  }
  const std::string id = present.name().substr(std::string(kItems).size() + 1);
  MORTISE_RETURN_IF_ERROR(transaction.Delete(kItems, id, present.revision()));
  return AppendEvent(transaction, "item.deleted", present.name(),
                     {{"revision", present.revision()}}, author);
}

}  // namespace mortise::catalog
