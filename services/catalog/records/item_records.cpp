// Items in the store.
#include <google/protobuf/util/time_util.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/message_checks.h"
#include "common/files/template_codec.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/item_filter.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_page.h"
#include "services/catalog/records/record_update.h"
#include "services/catalog/records/record_users.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

absl::StatusOr<v1::Item> ItemOf(const store::Record& record) {
  v1::Item item;
  if (!item.ParseFromString(record.payload)) {
    return StorageFailed("items/" + record.key, "the record cannot be read");
  }
  item.set_revision(record.revision);
  *item.mutable_update_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(record.updated_at));
  return item;
}

// Fields that the service alone sets are not kept in payloads.
std::string PayloadOf(v1::Item item) {
  item.clear_revision();
  item.clear_update_time();
  return item.SerializeAsString();
}

// Writes an item as the revision after `present`, 0 for a new one, and tells of it.
absl::StatusOr<int64_t> Write(store::Transaction& transaction, const v1::Item& item,
                              int64_t present, const std::string& trace_id) {
  MORTISE_ASSIGN_OR_RETURN(
      const int64_t revision,
      present == 0 ? PutNew(transaction, kItems, item.name(), PayloadOf(item))
                   : PutNext(transaction, kItems, item.name(), PayloadOf(item), present));
  MORTISE_RETURN_IF_ERROR(AppendEvent(transaction, present == 0 ? "item.created" : "item.updated",
                                      item.name(),
                                      {{"title", item.title()}, {"revision", revision}}, trace_id));
  return revision;
}

// Whether the latest revision in a record uses the item.
template <typename Bundle>
bool Uses(const store::Record& record, const std::string& item) {
  Bundle bundle;
  return bundle.ParseFromString(record.payload) && UsesItem(bundle, item);
}

// Names are what people write: one that is malformed counts as one that does not exist.
bool IsMissing(const absl::Status& status) {
  return absl::IsNotFound(status) || absl::IsInvalidArgument(status);
}

}  // namespace

absl::StatusOr<v1::Item> GetItem(store::ReadTransaction& transaction, const std::string& name,
                                 int64_t revision) {
  MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                           GetRecord(transaction, kItems, name, revision));
  return ItemOf(record);
}

absl::StatusOr<Page<v1::Item>> ListItems(store::ReadTransaction& transaction,
                                         const v1::ListItemsRequest& request) {
  const absl::StatusOr<ItemFilter> filter = ItemFilter::Create(transaction, request);
  MORTISE_RETURN_IF_ERROR(Together(filter.status(), resources::ReadPageQuery(request).status()));
  return ReadPage<v1::Item>(
      transaction, kItems, request,
      [&filter](const store::Record& record) -> absl::StatusOr<std::optional<v1::Item>> {
        MORTISE_ASSIGN_OR_RETURN(v1::Item item, ItemOf(record));
        if (!filter->Takes(item)) return std::nullopt;
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
  std::vector<FieldViolation> findings = parametric::CheckItemMessage(item, materials);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FieldViolation> of_shape,
                           CheckItemShape(transaction, item));
  findings.insert(findings.end(), of_shape.begin(), of_shape.end());
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
                                    const std::string& trace_id) {
  const auto findings = CheckItem(transaction, item);
  if (!findings.ok()) return UnderField("item", findings.status());
  MORTISE_RETURN_IF_ERROR(UnderField("item", parametric::ToStatus(*findings)));
  MORTISE_RETURN_IF_ERROR(Write(transaction, item, 0, trace_id).status());
  return GetItem(transaction, item.name());
}

absl::StatusOr<v1::Item> UpdateItem(store::Transaction& transaction,
                                    const v1::UpdateItemRequest& request,
                                    const std::string& trace_id) {
  MORTISE_RETURN_IF_ERROR(CheckUpdateMask<v1::Item>(request.update_mask()));
  absl::StatusOr<v1::Item> present = GetItem(transaction, request.item().name());
  if (absl::IsInvalidArgument(present.status())) return UnderField("item", present.status());
  MORTISE_RETURN_IF_ERROR(present.status());
  if (present->revision() != request.item().revision()) {
    return StaleRevision(present->name(), request.item().revision(), present->revision());
  }
  const v1::Item changed = Updated(*present, request.item(), request.update_mask());
  const auto findings = CheckItem(transaction, changed);
  if (!findings.ok()) return UnderField("item", findings.status());
  MORTISE_RETURN_IF_ERROR(UnderField("item", parametric::ToStatus(*findings)));
  MORTISE_RETURN_IF_ERROR(Write(transaction, changed, present->revision(), trace_id).status());
  return GetItem(transaction, changed.name());
}

absl::StatusOr<Replacement> ReplaceItem(store::Transaction& transaction, const v1::Item& item,
                                        const std::string& trace_id) {
  absl::StatusOr<v1::Item> present = GetItem(transaction, item.name());
  if (!absl::IsNotFound(present.status())) MORTISE_RETURN_IF_ERROR(present.status());
  Replacement replaced{.before = present.ok() ? present->revision() : 0};
  replaced.revision = replaced.before;
  if (present.ok() && PayloadOf(*present) == PayloadOf(item)) return replaced;
  MORTISE_ASSIGN_OR_RETURN(replaced.revision, Write(transaction, item, replaced.before, trace_id));
  return replaced;
}

absl::Status DeleteItem(store::Transaction& transaction, const v1::DeleteItemRequest& request,
                        const std::string& trace_id) {
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
                     {{"revision", present.revision()}}, trace_id);
}

}  // namespace mortise::catalog
