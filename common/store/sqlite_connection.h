// One connection to an SQLite file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <unordered_map>

#include "common/store/sql.h"

struct sqlite3;
struct sqlite3_stmt;

namespace mortise::store {

class SqliteConnection final : public SqlConnection {
 public:
  enum class Use { kWrite, kRead };

  // Opens the file in WAL mode with synchronous=NORMAL, creating it for kWrite. INTERNAL,
  // STORAGE_FAILED naming the path.
  static absl::StatusOr<std::unique_ptr<SqliteConnection>> Open(const std::filesystem::path& path,
                                                                Use use);
  ~SqliteConnection() override;

  absl::StatusOr<SqlResult> Run(const char* sql, absl::Span<const SqlValue> values) override;
  absl::Status Execute(const std::string& sql) override;

  // Returns the first failure since Begin; OK if none.
  const absl::Status& failure() const { return failure_; }

  // Begins a transaction: BEGIN IMMEDIATE for kWrite. UNAVAILABLE if another process stays in it.
  absl::Status Begin();
  absl::Status Commit();
  void Rollback();

 private:
  SqliteConnection(std::filesystem::path path, Use use, sqlite3* database);

  absl::StatusOr<sqlite3_stmt*> Prepared(const char* sql);
  absl::Status Failure(int code);

  std::filesystem::path path_;
  Use use_;
  sqlite3* database_;                                          // owned; closed by the destructor
  std::unordered_map<const char*, sqlite3_stmt*> statements_;  // owned; by the literal's address
  absl::Status failure_;
};

}  // namespace mortise::store
