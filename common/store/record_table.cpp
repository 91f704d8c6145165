#include "common/store/record_table.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/store/limits.h"

namespace mortise::store {
namespace {

std::string NameOf(std::string_view kind, std::string_view key) {
  return absl::StrCat(std::string(kind), "/", std::string(key));
}

absl::Status CheckRecordName(std::string_view kind, std::string_view key) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("kind", kind));
  return CheckRequiredName("key", key);
}

// Columns: kind, key, revision, payload, created_at, updated_at.
Record RecordOf(SqlRow& row) {
  return {.kind = std::move(row[0].text),
          .key = std::move(row[1].text),
          .revision = row[2].integer,
          .payload = std::move(row[3].text),
          .created_at = absl::FromUnixMicros(row[4].integer),
          .updated_at = absl::FromUnixMicros(row[5].integer)};
}

}  // namespace

std::string EndOfPrefix(std::string_view prefix) {
  return std::string(prefix) + "\xF4\x8F\xBF\xBF";  // U+10FFFF, which no name contains
}

absl::StatusOr<Record> RecordTable::Get(std::string_view kind, std::string_view key) {
  MORTISE_RETURN_IF_ERROR(CheckRecordName(kind, key));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT kind, key, revision, payload, created_at, updated_at FROM records"
                       " WHERE kind = $1 AND key = $2",
                       {kind, key}));
  if (result.rows.empty()) return ResourceNotFound(NameOf(kind, key));
  return RecordOf(result.rows[0]);
}

absl::StatusOr<Record> RecordTable::GetRevision(std::string_view kind, std::string_view key,
                                                int64_t revision) {
  MORTISE_RETURN_IF_ERROR(CheckRecordName(kind, key));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT kind, key, revision, payload, created_at, updated_at FROM records"
                       " WHERE kind = $1 AND key = $2 AND revision = $3 UNION ALL "
                       "SELECT kind, key, revision, payload, created_at, updated_at"
                       " FROM record_history WHERE kind = $1 AND key = $2 AND revision = $3",
                       {kind, key, revision}));
  if (result.rows.empty()) {
    return ResourceNotFound(absl::StrCat(NameOf(kind, key), "/revisions/", revision));
  }
  return RecordOf(result.rows[0]);
}

absl::StatusOr<std::vector<Record>> RecordTable::List(std::string_view kind,
                                                      const ListOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("kind", kind));
  MORTISE_RETURN_IF_ERROR(CheckName("after_key", options.after_key));
  MORTISE_RETURN_IF_ERROR(CheckName("key_prefix", options.key_prefix));
  MORTISE_RETURN_IF_ERROR(CheckLimit("limit", options.limit));
  const std::string end = EndOfPrefix(options.key_prefix);
  const std::string below =
      options.descending && !options.after_key.empty() ? std::min(options.after_key, end) : end;
  const int64_t with_payloads = options.without_payloads ? 0 : 1;
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      options.descending
          ? connection_->Run(
                "SELECT kind, key, revision, CASE WHEN $1 = 1 THEN payload END, created_at,"
                " updated_at FROM records"
                " WHERE kind = $2 AND key >= $3 AND key < $4 ORDER BY key DESC LIMIT $5",
                {with_payloads, kind, options.key_prefix, below, int64_t{options.limit}})
          : connection_->Run(
                "SELECT kind, key, revision, CASE WHEN $1 = 1 THEN payload END, created_at,"
                " updated_at FROM records"
                " WHERE kind = $2 AND key > $3 AND key >= $4 AND key < $5 ORDER BY key LIMIT $6",
                {with_payloads, kind, options.after_key, options.key_prefix, end,
                 int64_t{options.limit}}));
  std::vector<Record> records;
  records.reserve(result.rows.size());
  for (SqlRow& row : result.rows) records.push_back(RecordOf(row));
  return records;
}

absl::StatusOr<int64_t> RecordTable::CurrentRevision(std::string_view kind, std::string_view key) {
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT revision FROM records WHERE kind = $1 AND key = $2 FOR UPDATE",
                       {kind, key}));
  return result.rows.empty() ? 0 : result.rows[0][0].integer;
}

absl::StatusOr<int64_t> RecordTable::Put(std::string_view kind, std::string_view key,
                                         std::string_view payload, const PutOptions& options,
                                         absl::Time now) {
  MORTISE_RETURN_IF_ERROR(CheckRecordName(kind, key));
  MORTISE_RETURN_IF_ERROR(CheckPayload("payload", payload));
  MORTISE_ASSIGN_OR_RETURN(const int64_t current, CurrentRevision(kind, key));
  if (options.expected_revision && *options.expected_revision != current) {
    return StaleRevision(NameOf(kind, key), *options.expected_revision, current);
  }
  if (options.keep_history && current > 0) {
    MORTISE_RETURN_IF_ERROR(
        connection_
            ->Run("INSERT INTO record_history"
                  " (kind, key, revision, payload, created_at, updated_at)"
                  " SELECT kind, key, revision, payload, created_at, updated_at FROM records"
                  " WHERE kind = $1 AND key = $2",
                  {kind, key})
            .status());
  }
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("INSERT INTO records (kind, key, revision, payload, created_at, updated_at)"
                       " VALUES ($1, $2, 1, $3, $4, $4) ON CONFLICT (kind, key) DO UPDATE SET"
                       " revision = records.revision + 1, payload = excluded.payload,"
                       " updated_at = excluded.updated_at RETURNING revision",
                       {kind, key, SqlBytes{payload}, absl::ToUnixMicros(now)}));
  // Under read-committed isolation two writers can both find no record and both insert.
  const int64_t revision = result.rows.empty() ? 0 : result.rows[0][0].integer;
  if (options.expected_revision && revision != current + 1) {
    return StaleRevision(NameOf(kind, key), *options.expected_revision, revision - 1);
  }
  return revision;
}

absl::Status RecordTable::Delete(std::string_view kind, std::string_view key,
                                 std::optional<int64_t> expected_revision) {
  MORTISE_RETURN_IF_ERROR(CheckRecordName(kind, key));
  MORTISE_ASSIGN_OR_RETURN(const int64_t current, CurrentRevision(kind, key));
  if (current == 0) return ResourceNotFound(NameOf(kind, key));
  if (expected_revision && *expected_revision != current) {
    return StaleRevision(NameOf(kind, key), *expected_revision, current);
  }
  MORTISE_RETURN_IF_ERROR(
      connection_->Run("DELETE FROM record_history WHERE kind = $1 AND key = $2", {kind, key})
          .status());
  return connection_->Run("DELETE FROM records WHERE kind = $1 AND key = $2", {kind, key}).status();
}

}  // namespace mortise::store
