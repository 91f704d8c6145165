#include "common/store/schema.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"

namespace mortise::store {
namespace {

constexpr int64_t kVersion = 1;

// Times are microseconds since 1970. States of tasks: the values of TaskState.
// outbox holds committed events that have no number yet; the relay moves them to events.
constexpr const char* kStatements[] = {
    R"(CREATE TABLE IF NOT EXISTS store_version (
      id {number} PRIMARY KEY, version BIGINT NOT NULL, opened_at BIGINT NOT NULL))",
    R"(CREATE TABLE IF NOT EXISTS records (
      kind {text} NOT NULL, key {text} NOT NULL, revision BIGINT NOT NULL, payload {bytes} NOT NULL,
      created_at BIGINT NOT NULL, updated_at BIGINT NOT NULL, PRIMARY KEY (kind, key)))",
    R"(CREATE TABLE IF NOT EXISTS record_history (
      kind {text} NOT NULL, key {text} NOT NULL, revision BIGINT NOT NULL, payload {bytes} NOT NULL,
      created_at BIGINT NOT NULL, updated_at BIGINT NOT NULL, PRIMARY KEY (kind, key, revision)))",
    R"(CREATE TABLE IF NOT EXISTS outbox (
      id {identity}, time BIGINT NOT NULL, type {text} NOT NULL, subject {text} NOT NULL,
      payload {bytes} NOT NULL, trace_id {text} NOT NULL))",
    R"(CREATE TABLE IF NOT EXISTS events (
      number {number} PRIMARY KEY, epoch BIGINT NOT NULL, time BIGINT NOT NULL,
      type {text} NOT NULL, subject {text} NOT NULL, payload {bytes} NOT NULL,
      trace_id {text} NOT NULL))",
    R"(CREATE TABLE IF NOT EXISTS event_stream (
      id {number} PRIMARY KEY, epoch BIGINT NOT NULL, latest_number BIGINT NOT NULL))",
    R"(INSERT INTO event_stream (id, epoch, latest_number) VALUES (1, 0, 0) ON CONFLICT DO NOTHING)",
    R"(CREATE TABLE IF NOT EXISTS tasks (
      arrival {identity}, queue {text} NOT NULL, key {text} NOT NULL, payload {bytes} NOT NULL,
      state BIGINT NOT NULL, attempt BIGINT NOT NULL, counted_attempts BIGINT NOT NULL,
      max_attempts BIGINT NOT NULL, priority BIGINT NOT NULL, due_at BIGINT NOT NULL,
      worker {text} NOT NULL, lease_expires_at BIGINT NOT NULL, result {bytes} NOT NULL,
      error {bytes} NOT NULL, created_at BIGINT NOT NULL, updated_at BIGINT NOT NULL,
      UNIQUE (queue, key)))",
    R"(CREATE INDEX IF NOT EXISTS tasks_waiting ON tasks (queue, priority DESC, arrival)
      WHERE state = 0)",
    R"(CREATE INDEX IF NOT EXISTS tasks_leased ON tasks (queue, lease_expires_at)
      WHERE state = 1)",
    R"(CREATE INDEX IF NOT EXISTS tasks_by_state ON tasks (queue, state))",
};

std::string InDialect(const char* statement, const SchemaDialect& dialect) {
  return absl::StrReplaceAll(statement, {{"{bytes}", dialect.bytes},
                                         {"{text}", dialect.text},
                                         {"{number}", dialect.number},
                                         {"{identity}", dialect.identity}});
}

}  // namespace

absl::Status PrepareSchema(const SchemaDialect& dialect, absl::Time now,
                           SqlConnection* connection) {
  for (const char* statement : kStatements) {
    MORTISE_RETURN_IF_ERROR(connection->Execute(InDialect(statement, dialect)));
  }
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult found,
      connection->Run("INSERT INTO store_version (id, version, opened_at) VALUES (1, $1, $2)"
                      " ON CONFLICT (id) DO UPDATE SET opened_at = excluded.opened_at"
                      " RETURNING version",
                      {kVersion, absl::ToUnixMicros(now)}));
  if (found.rows.size() != 1 || found.rows[0][0].integer > kVersion) {
    return PreconditionFailed("STORE_TOO_NEW",
                              absl::StrCat("the store was made by a later version of the program; "
                                           "this one knows version ",
                                           kVersion));
  }
  return absl::OkStatus();
}

}  // namespace mortise::store
