// Reads and writes records of any kind.
#include "services/catalog/records/record_access.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "services/catalog/records/near_names.h"

namespace mortise::catalog {

absl::StatusOr<store::Record> GetRecord(store::ReadTransaction& transaction, const char* kind,
                                        const std::string& name, int64_t revision) {
  const absl::StatusOr<std::string> id = ParseResourceName(name, kind, "name");
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(id.status(), revision < 0 ? InvalidField("revision", "must be at least 0")
                                                  : absl::OkStatus()));
  absl::StatusOr<store::Record> record =
      revision == 0 ? transaction.Get(kind, *id) : transaction.GetRevision(kind, *id, revision);
  if (absl::IsNotFound(record.status()) || (record.ok() && IsDeleted(*record))) {
    return ResourceNotFound(revision == 0 ? name : absl::StrCat(name, "/revisions/", revision));
  }
  return record;
}

absl::StatusOr<store::Record> GetRecordOrNone(store::ReadTransaction& transaction, const char* kind,
                                              const std::string& name, const std::string& field) {
  absl::StatusOr<store::Record> record = GetRecord(transaction, kind, name);
  if (absl::IsNotFound(record.status())) return store::Record{};
  if (!record.ok()) return UnderField(field, record.status());
  return record;
}

absl::StatusOr<int64_t> PutNew(store::Transaction& transaction, const char* kind,
                               const std::string& name, const std::string& payload) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, kind, "name"));
  absl::StatusOr<int64_t> revision =
      transaction.Put(kind, id, payload, {.expected_revision = 0, .keep_history = false});
  if (absl::IsAborted(revision.status()) &&
      DetailOf(revision.status()).reason == "STALE_REVISION") {
    return ResourceExists(name);
  }
  return revision;
}

absl::Status WithRevisionFault(store::Store& store, const char* kind, const std::string& name,
                               int64_t expected, const absl::Status& faults) {
  if (expected < 0) {
    return CombineViolations(InvalidField("expected_revision", "must be at least 0"), faults);
  }
  if (!absl::IsInvalidArgument(faults)) return faults;
  int64_t latest = 0;
  const absl::Status found = store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                             GetRecordOrNone(transaction, kind, name, ""));
    latest = record.revision;
    return absl::OkStatus();
  });
  // Of a name that is none there are no revisions.
  if (!found.ok() || latest == expected) return faults;
  return CombineViolations(
      InvalidField("expected_revision", absl::StrCat("the latest revision is ", latest)), faults);
}

absl::StatusOr<int64_t> PutNext(store::Transaction& transaction, const char* kind,
                                const std::string& name, const std::string& payload,
                                int64_t present) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, kind, "name"));
  if (present == 0) {
    const absl::StatusOr<store::Record> latest = transaction.Get(kind, id);
    if (!absl::IsNotFound(latest.status())) MORTISE_RETURN_IF_ERROR(latest.status());
    if (latest.ok() && IsDeleted(*latest)) present = latest->revision;
  }
  return transaction.Put(kind, id, payload, {.expected_revision = present, .keep_history = true});
}

absl::Status MarkDeleted(store::Transaction& transaction, const char* kind, const std::string& name,
                         int64_t revision) {
  MORTISE_ASSIGN_OR_RETURN(const store::Record present,
                           OrNearName(transaction, kind, name, GetRecord(transaction, kind, name)));
  if (present.revision != revision) return StaleRevision(name, revision, present.revision);
  return PutNext(transaction, kind, name, "", revision).status();
}

absl::Status AppendEvent(store::Transaction& transaction, const std::string& type,
                         const std::string& subject, const nlohmann::json& data,
                         const resources::Author& author) {
  return transaction.AppendEvent(
      {.type = type, .subject = subject, .payload = data.dump(), .trace_id = author.trace_id});
}

}  // namespace mortise::catalog
