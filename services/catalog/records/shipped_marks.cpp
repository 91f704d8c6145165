// Marks as records, and the decision that follows from them.
#include "services/catalog/records/shipped_marks.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {
namespace {

constexpr const char* kMarks = "shipped";
constexpr const char* kCollection = "collection";  // the mark of all of it; names have a slash
constexpr int kPage = 1000;

bool HasInteger(const nlohmann::json& json, const char* field) {
  return json.is_object() && json.contains(field) && json[field].is_number_integer();
}

absl::Status Unreadable(const std::string& name) {
  return StorageFailed(absl::StrCat(kMarks, "/", name), "the record cannot be read");
}

}  // namespace

bool IsAsShipped(const std::optional<ShippedMark>& mark,
                 const std::optional<PresentRevision>& present) {
  return mark && present && mark->revision == present->revision &&
         mark->created_at == present->created_at;
}

absl::StatusOr<Delivery> DecideDelivery(const DeliveryQuestion& question) {
  const auto& [digest, mark, present, filled_at, is_newer] = question;
  const bool failed = mark && mark->failed;
  if (mark && mark->digest == digest && !(failed && is_newer)) return Delivery::kNone;
  if (!present) {
    const bool never_came = !mark || (failed && mark->revision == 0);
    return never_came ? Delivery::kCreate : Delivery::kNone;
  }
  if (mark) return IsAsShipped(mark, present) ? Delivery::kUpdate : Delivery::kKeepOwn;
  MORTISE_ASSIGN_OR_RETURN(const absl::Time filled, filled_at());
  const bool as_filled = present->revision == 1 && present->created_at == filled;
  return as_filled ? Delivery::kUpdate : Delivery::kKeepOwn;
}

absl::StatusOr<int64_t> GetCollectionNumber(store::ReadTransaction& transaction) {
  const absl::StatusOr<store::Record> record = transaction.Get(kMarks, kCollection);
  if (absl::IsNotFound(record.status())) return 0;
  MORTISE_RETURN_IF_ERROR(record.status());
  const auto json = nlohmann::json::parse(record->payload, nullptr, false);
  if (!HasInteger(json, "number")) return Unreadable(kCollection);
  return json["number"].get<int64_t>();
}

absl::Status PutCollectionNumber(store::Transaction& transaction, int64_t number) {
  return transaction.Put(kMarks, kCollection, nlohmann::json{{"number", number}}.dump()).status();
}

absl::StatusOr<std::optional<ShippedMark>> GetMark(store::ReadTransaction& transaction,
                                                   const std::string& name) {
  const absl::StatusOr<store::Record> record = transaction.Get(kMarks, name);
  if (absl::IsNotFound(record.status())) return std::optional<ShippedMark>();
  MORTISE_RETURN_IF_ERROR(record.status());
  const auto json = nlohmann::json::parse(record->payload, nullptr, false);
  if (!HasInteger(json, "revision") || !HasInteger(json, "created_at") ||
      !json.contains("digest") || !json["digest"].is_string()) {
    return Unreadable(name);
  }
  return std::optional<ShippedMark>(
      ShippedMark{.digest = json["digest"].get<std::string>(),
                  .revision = json["revision"].get<int64_t>(),
                  .created_at = absl::FromUnixMicros(json["created_at"].get<int64_t>()),
                  .failed = json.contains("failed")});
}

absl::Status PutMark(store::Transaction& transaction, const std::string& name,
                     const ShippedMark& mark) {
  nlohmann::json json = {{"digest", mark.digest},
                         {"revision", mark.revision},
                         {"created_at", absl::ToUnixMicros(mark.created_at)}};
  if (mark.failed) json["failed"] = true;
  return transaction.Put(kMarks, name, json.dump()).status();
}

absl::Status MoveMark(store::Transaction& transaction, const std::string& name, int64_t from,
                      int64_t to) {
  MORTISE_ASSIGN_OR_RETURN(std::optional<ShippedMark> mark, GetMark(transaction, name));
  if (!mark || mark->revision != from) return absl::OkStatus();
  mark->revision = to;
  return PutMark(transaction, name, *mark);
}

absl::StatusOr<std::optional<PresentRevision>> FindPresent(store::ReadTransaction& transaction,
                                                           const char* kind,
                                                           const std::string& name) {
  const absl::StatusOr<store::Record> record = GetRecord(transaction, kind, name);
  if (absl::IsNotFound(record.status())) return std::optional<PresentRevision>();
  MORTISE_RETURN_IF_ERROR(record.status());
  return std::optional<PresentRevision>(PresentRevision{record->revision, record->created_at});
}

absl::StatusOr<StoreOrigin> OriginOf(store::ReadTransaction& transaction) {
  absl::Time first = absl::InfiniteFuture();
  int64_t at_first = 0;
  for (const char* kind : {kMaterials, kItems, kTemplates, kAssemblies}) {
    store::ListOptions list;
    list.limit = kPage;
    list.without_payloads = true;
    while (true) {
      MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page, transaction.List(kind, list));
      for (const store::Record& record : page) {
        if (record.created_at < first) at_first = 0;
        first = std::min(first, record.created_at);
        if (record.created_at == first) ++at_first;
      }
      if (static_cast<int>(page.size()) < kPage) break;
      list.after_key = page.back().key;
    }
  }
  return StoreOrigin{at_first == 0, at_first > 1 ? first : absl::InfiniteFuture()};
}

}  // namespace mortise::catalog
