#include "common/store/sqlite_connection.h"

#include <sqlite3.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"

namespace mortise::store {
namespace {

constexpr int kBusyMilliseconds = 10000;

absl::Status Explain(const std::filesystem::path& path, int code, std::string_view message) {
  const int primary = code & 0xFF;
  if (primary == SQLITE_BUSY || primary == SQLITE_LOCKED) {
    return PeerUnavailable(path.string(), "another process keeps the database locked");
  }
  if (primary == SQLITE_FULL) return StorageFailed(path.string(), "the disk is full");
  if (primary == SQLITE_READONLY) return StorageFailed(path.string(), "it cannot be written");
  return StorageFailed(path.string(), message);
}

// Binds $1 … in the order of `values`, whatever the order of their use.
int Bind(sqlite3_stmt* statement, absl::Span<const SqlValue> values) {
  int position = 0;
  for (const SqlValue& value : values) {
    const std::string name = absl::StrCat("$", ++position);
    const int index = sqlite3_bind_parameter_index(statement, name.c_str());
    int code = SQLITE_OK;
    if (const auto* integer = std::get_if<int64_t>(&value)) {
      code = sqlite3_bind_int64(statement, index, *integer);
    } else if (const auto* text = std::get_if<std::string_view>(&value)) {
      const char* data = text->empty() ? "" : text->data();
      code = sqlite3_bind_text64(statement, index, data, text->size(), SQLITE_STATIC, SQLITE_UTF8);
    } else {
      const std::string_view bytes = std::get<SqlBytes>(value).bytes;
      const char* data = bytes.empty() ? "" : bytes.data();
      code = sqlite3_bind_blob64(statement, index, data, bytes.size(), SQLITE_STATIC);
    }
    if (code != SQLITE_OK) return code;
  }
  return SQLITE_OK;
}

SqlRow RowOf(sqlite3_stmt* statement, int columns) {
  SqlRow row(static_cast<std::size_t>(columns));
  for (int i = 0; i < columns; ++i) {
    SqlCell& cell = row[static_cast<std::size_t>(i)];
    if (sqlite3_column_type(statement, i) == SQLITE_INTEGER) {
      cell.integer = sqlite3_column_int64(statement, i);
    } else if (const void* data = sqlite3_column_blob(statement, i)) {
      cell.text.assign(static_cast<const char*>(data),
                       static_cast<std::size_t>(sqlite3_column_bytes(statement, i)));
    }
  }
  return row;
}

}  // namespace

SqliteConnection::SqliteConnection(std::filesystem::path path, Use use, sqlite3* database)
    : path_(std::move(path)), use_(use), database_(database) {}

absl::StatusOr<std::unique_ptr<SqliteConnection>> SqliteConnection::Open(
    const std::filesystem::path& path, Use use) {
  sqlite3* database = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE |
                    (use == Use::kWrite ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2(path.c_str(), &database, flags, nullptr);
  std::unique_ptr<SqliteConnection> connection(new SqliteConnection(path, use, database));
  if (code != SQLITE_OK) {
    const int system_error = database == nullptr ? 0 : sqlite3_system_errno(database);
    return Explain(
        path, code,
        absl::StrCat("it cannot be opened: ",
                     system_error == 0 ? sqlite3_errstr(code) : std::strerror(system_error)));
  }
  sqlite3_busy_timeout(database, kBusyMilliseconds);
  MORTISE_RETURN_IF_ERROR(connection->Execute("PRAGMA journal_mode = WAL"));
  MORTISE_RETURN_IF_ERROR(connection->Execute("PRAGMA synchronous = NORMAL"));
  MORTISE_RETURN_IF_ERROR(connection->Execute("PRAGMA temp_store = MEMORY"));
  MORTISE_RETURN_IF_ERROR(connection->Execute("PRAGMA cache_size = -16000"));  // KiB
  if (use == Use::kRead) {
    MORTISE_RETURN_IF_ERROR(connection->Execute("PRAGMA query_only = 1"));
  }
  return connection;
}

SqliteConnection::~SqliteConnection() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(database_);
}

absl::Status SqliteConnection::Failure(int code) {
  absl::Status status = Explain(path_, code, sqlite3_errmsg(database_));
  if (failure_.ok()) failure_ = status;
  return status;
}

absl::StatusOr<sqlite3_stmt*> SqliteConnection::Prepared(const char* sql) {
  sqlite3_stmt*& statement = statements_[sql];
  if (statement != nullptr) return statement;
  const std::string translated =
      absl::StrReplaceAll(sql, {{" FOR UPDATE SKIP LOCKED", ""}, {" FOR UPDATE", ""}});
  const int code = sqlite3_prepare_v3(database_, translated.c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                      &statement, nullptr);
  if (code != SQLITE_OK) return Failure(code);
  return statement;
}

absl::StatusOr<SqlResult> SqliteConnection::Run(const char* sql,
                                                absl::Span<const SqlValue> values) {
  MORTISE_ASSIGN_OR_RETURN(sqlite3_stmt * statement, Prepared(sql));
  SqlResult result;
  int code = Bind(statement, values);
  const int columns = sqlite3_column_count(statement);
  while (code == SQLITE_OK || code == SQLITE_ROW) {
    code = sqlite3_step(statement);
    if (code == SQLITE_ROW) result.rows.push_back(RowOf(statement, columns));
  }
  absl::Status status = code == SQLITE_DONE ? absl::OkStatus() : Failure(code);
  result.changed = sqlite3_changes64(database_);
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  if (!status.ok()) return status;
  return result;
}

absl::Status SqliteConnection::Execute(const std::string& sql) {
  const int code = sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : Failure(code);
}

absl::Status SqliteConnection::Begin() {
  failure_ = absl::OkStatus();
  return Execute(use_ == Use::kWrite ? "BEGIN IMMEDIATE" : "BEGIN");
}

absl::Status SqliteConnection::Commit() { return Execute("COMMIT"); }

void SqliteConnection::Rollback() {
  // Some failures have rolled back already.
  if (sqlite3_get_autocommit(database_) == 0) Execute("ROLLBACK").IgnoreError();
}

}  // namespace mortise::store
