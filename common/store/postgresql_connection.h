// One connection to a PostgreSQL server.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include "common/store/sql.h"

struct pg_conn;
struct pg_result;

namespace mortise::store {

class PostgresqlConnection final : public SqlConnection {
 public:
  // Connects, and makes `schema` (created if missing) the place of all tables. UNAVAILABLE if the
  // server cannot be reached; the message never shows the password.
  static absl::StatusOr<std::unique_ptr<PostgresqlConnection>> Open(const std::string& url,
                                                                    const std::string& schema);
  ~PostgresqlConnection() override;

  absl::StatusOr<SqlResult> Run(const char* sql, absl::Span<const SqlValue> values) override;
  absl::Status Execute(const std::string& sql) override;

  // Returns the first failure since Begin; OK if none.
  const absl::Status& failure() const { return failure_; }

  // Whether a failure since Begin was that others got in the way, or that the connection was lost
  // before the commit was asked for: nothing has happened, and the transaction may be repeated.
  bool repeatable() const { return repeatable_; }

  // Begins with a statement such as "BEGIN ISOLATION LEVEL SERIALIZABLE", which must outlive the
  // transaction, reconnecting if the connection was lost. The server hears of it with the first
  // statement, which saves one way there and back.
  absl::Status Begin(const char* begin);

  // Fails with UNAVAILABLE, reason COMMIT_UNKNOWN if the connection is lost before the answer
  // comes.
  absl::Status Commit();

  void Rollback();

 private:
  PostgresqlConnection(std::string schema, pg_conn* connection);

  struct Parameters;
  absl::StatusOr<SqlResult> RunWithBegin(const std::string& name, const Parameters& parameters);
  absl::Status Prepare(const char* sql, absl::Span<const SqlValue> values, std::string* name);
  absl::Status UseSchema();
  absl::Status Reconnect();
  absl::Status Failure(const pg_result* result);
  bool lost() const;  // whether the connection is gone

  std::string schema_;
  pg_conn* connection_;                                    // owned; closed by the destructor
  std::unordered_map<const char*, std::string> prepared_;  // names, by the literal's address
  const char* begin_ = nullptr;                            // not sent yet
  absl::Status failure_;
  bool repeatable_ = false;
  bool broken_ = false;  // libpq failed by itself, and does not always say CONNECTION_BAD
};

}  // namespace mortise::store
