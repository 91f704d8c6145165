// What was shipped, as records, and the decision that follows from them.
#include "services/catalog/records/shipped_revisions.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {
namespace {

constexpr const char* kShipped = "shipped";
constexpr const char* kCollection = "collection";  // of all of it; names have a slash
constexpr int kPage = 1000;

bool HasInteger(const nlohmann::json& json, const char* field) {
  return json.is_object() && json.contains(field) && json[field].is_number_integer();
}

absl::Status Unreadable(const std::string& name) {
  return StorageFailed(absl::StrCat(kShipped, "/", name), "the record cannot be read");
}

}  // namespace

bool IsAsShipped(const std::optional<ShippedRevision>& shipped,
                 const std::optional<PresentRevision>& present) {
  return shipped && present && shipped->revision == present->revision &&
         shipped->created_at == present->created_at;
}

absl::StatusOr<Delivery> DecideDelivery(const DeliveryQuestion& question) {
  const auto& [digest, shipped, present, filled_at, is_newer] = question;
  const bool failed = shipped && shipped->failed;
  if (shipped && shipped->digest == digest && !(failed && is_newer)) return Delivery::kNone;
  if (!present) {
    const bool never_came = !shipped || (failed && shipped->revision == 0);
    return never_came ? Delivery::kCreate : Delivery::kNone;
  }
  if (shipped) return IsAsShipped(shipped, present) ? Delivery::kUpdate : Delivery::kKeepOwn;
  MORTISE_ASSIGN_OR_RETURN(const absl::Time filled, filled_at());
  const bool as_filled = present->revision == 1 && present->created_at == filled;
  return as_filled ? Delivery::kUpdate : Delivery::kKeepOwn;
}

absl::StatusOr<int64_t> GetCollectionNumber(store::ReadTransaction& transaction) {
  const absl::StatusOr<store::Record> record = transaction.Get(kShipped, kCollection);
  if (absl::IsNotFound(record.status())) return 0;
  MORTISE_RETURN_IF_ERROR(record.status());
  const auto json = nlohmann::json::parse(record->payload, nullptr, false);
  if (!HasInteger(json, "number")) return Unreadable(kCollection);
  return json["number"].get<int64_t>();
}

absl::Status PutCollectionNumber(store::Transaction& transaction, int64_t number) {
  return transaction.Put(kShipped, kCollection, nlohmann::json{{"number", number}}.dump()).status();
}

absl::StatusOr<std::optional<ShippedRevision>> GetShippedRevision(
    store::ReadTransaction& transaction, const std::string& name) {
  const absl::StatusOr<store::Record> record = transaction.Get(kShipped, name);
  if (absl::IsNotFound(record.status())) return std::optional<ShippedRevision>();
  MORTISE_RETURN_IF_ERROR(record.status());
  const auto json = nlohmann::json::parse(record->payload, nullptr, false);
  if (!HasInteger(json, "revision") || !HasInteger(json, "created_at") ||
      !json.contains("digest") || !json["digest"].is_string()) {
    return Unreadable(name);
  }
  return std::optional<ShippedRevision>(
      ShippedRevision{.digest = json["digest"].get<std::string>(),
                      .revision = json["revision"].get<int64_t>(),
                      .created_at = absl::FromUnixMicros(json["created_at"].get<int64_t>()),
                      .failed = json.contains("failed")});
}

absl::Status PutShippedRevision(store::Transaction& transaction, const std::string& name,
                                const ShippedRevision& shipped) {
  nlohmann::json json = {{"digest", shipped.digest},
                         {"revision", shipped.revision},
                         {"created_at", absl::ToUnixMicros(shipped.created_at)}};
  if (shipped.failed) json["failed"] = true;
  return transaction.Put(kShipped, name, json.dump()).status();
}

absl::Status MoveShippedRevision(store::Transaction& transaction, const std::string& name,
                                 int64_t from, int64_t to) {
  MORTISE_ASSIGN_OR_RETURN(std::optional<ShippedRevision> shipped,
                           GetShippedRevision(transaction, name));
  if (!shipped || shipped->revision != from) return absl::OkStatus();
  shipped->revision = to;
  return PutShippedRevision(transaction, name, *shipped);
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
