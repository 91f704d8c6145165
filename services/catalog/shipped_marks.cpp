// Marks as records, and the decision that follows from them.
#include "services/catalog/shipped_marks.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/catalog/record_access.h"

namespace mortise::catalog {
namespace {

constexpr const char* kMarks = "shipped";
constexpr int kPage = 1000;

}  // namespace

bool IsAsShipped(const std::optional<ShippedMark>& mark,
                 const std::optional<PresentRevision>& present) {
  return mark && present && mark->revision == present->revision &&
         mark->created_at == present->created_at;
}

Delivery DecideDelivery(const std::optional<ShippedMark>& mark,
                        const std::optional<PresentRevision>& present, const std::string& digest,
                        absl::Time filled_at) {
  if (!present) return mark ? Delivery::kNone : Delivery::kCreate;
  if (mark) {
    if (mark->digest == digest) return Delivery::kNone;
    return IsAsShipped(mark, present) ? Delivery::kUpdate : Delivery::kKeepOwn;
  }
  const bool as_filled = present->revision == 1 && present->created_at == filled_at;
  return as_filled ? Delivery::kUpdate : Delivery::kKeepOwn;
}

absl::StatusOr<std::optional<ShippedMark>> GetMark(store::ReadTransaction& transaction,
                                                   const std::string& name) {
  const absl::StatusOr<store::Record> record = transaction.Get(kMarks, name);
  if (absl::IsNotFound(record.status())) return std::optional<ShippedMark>();
  MORTISE_RETURN_IF_ERROR(record.status());
  const auto json = nlohmann::json::parse(record->payload, nullptr, false);
  if (!json.is_object() || !json.contains("digest") || !json["digest"].is_string() ||
      !json.contains("revision") || !json["revision"].is_number_integer() ||
      !json.contains("created_at") || !json["created_at"].is_number_integer()) {
    return StorageFailed(absl::StrCat(kMarks, "/", name), "the record cannot be read");
  }
  return std::optional<ShippedMark>(
      ShippedMark{json["digest"].get<std::string>(), json["revision"].get<int64_t>(),
                  absl::FromUnixMicros(json["created_at"].get<int64_t>())});
}

absl::Status PutMark(store::Transaction& transaction, const std::string& name,
                     const ShippedMark& mark) {
  const nlohmann::json json = {{"digest", mark.digest},
                               {"revision", mark.revision},
                               {"created_at", absl::ToUnixMicros(mark.created_at)}};
  return transaction.Put(kMarks, name, json.dump()).status();
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
