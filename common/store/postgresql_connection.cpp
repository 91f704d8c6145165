#include "common/store/postgresql_connection.h"

#include <endian.h>
#include <libpq-fe.h>

#include <cstring>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::store {
namespace {

// Object identifiers of the built-in types, fixed by PostgreSQL's catalogue.
constexpr Oid kBytea = 17;
constexpr Oid kInt8 = 20;
constexpr Oid kText = 25;

struct ClearResult {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Result = std::unique_ptr<PGresult, ClearResult>;

bool Succeeded(const PGresult* result) {
  const ExecStatusType status = PQresultStatus(result);
  return status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK;
}

// The result of the next statement of a pipeline.
Result NextResult(pg_conn* connection) {
  Result result(PQgetResult(connection));
  while (result != nullptr && Result(PQgetResult(connection)) != nullptr) {
  }
  return result;
}

std::string Trimmed(const char* message) {
  return std::string(absl::StripAsciiWhitespace(message == nullptr ? "" : message));
}

SqlCell CellOf(const PGresult* result, int row, int column) {
  SqlCell cell;
  if (PQgetisnull(result, row, column)) return cell;
  const char* data = PQgetvalue(result, row, column);
  const auto length = static_cast<std::size_t>(PQgetlength(result, row, column));
  if (PQftype(result, column) == kInt8 && length == sizeof(uint64_t)) {
    uint64_t integer = 0;
    std::memcpy(&integer, data, sizeof(integer));
    cell.integer = static_cast<int64_t>(be64toh(integer));
  } else {
    cell.text.assign(data, length);
  }
  return cell;
}

SqlResult ResultOf(PGresult* result) {
  SqlResult answer;
  const int columns = PQnfields(result);
  answer.rows.resize(static_cast<std::size_t>(PQntuples(result)));
  for (std::size_t i = 0; i < answer.rows.size(); ++i) {
    answer.rows[i].reserve(static_cast<std::size_t>(columns));
    for (int j = 0; j < columns; ++j) {
      answer.rows[i].push_back(CellOf(result, static_cast<int>(i), j));
    }
  }
  answer.changed = std::strtoll(PQcmdTuples(result), nullptr, 10);
  return answer;
}

}  // namespace

// The values of a statement in the binary form the protocol wants.
struct PostgresqlConnection::Parameters {
 public:
  explicit Parameters(absl::Span<const SqlValue> values) : integers_(values.size()) {
    std::size_t i = 0;
    for (const SqlValue& value : values) {
      if (const auto* integer = std::get_if<int64_t>(&value)) {
        integers_[i] = htobe64(static_cast<uint64_t>(*integer));
        Add(kInt8, {reinterpret_cast<const char*>(&integers_[i]), sizeof(uint64_t)});
      } else if (const auto* text = std::get_if<std::string_view>(&value)) {
        Add(kText, *text);
      } else {
        Add(kBytea, std::get<SqlBytes>(value).bytes);
      }
      ++i;
    }
  }

  int size() const { return static_cast<int>(types_.size()); }
  const Oid* types() const { return types_.data(); }
  const char* const* data() const { return data_.data(); }
  const int* lengths() const { return lengths_.data(); }
  const int* formats() const { return formats_.data(); }

 private:
  void Add(Oid type, std::string_view bytes) {
    types_.push_back(type);
    data_.push_back(bytes.empty() ? "" : bytes.data());  // a null pointer would mean NULL
    lengths_.push_back(static_cast<int>(bytes.size()));
    formats_.push_back(1);
  }

  std::vector<uint64_t> integers_;
  std::vector<Oid> types_;
  std::vector<const char*> data_;
  std::vector<int> lengths_;
  std::vector<int> formats_;
};

PostgresqlConnection::PostgresqlConnection(std::string schema, pg_conn* connection)
    : schema_(std::move(schema)), connection_(connection) {}

PostgresqlConnection::~PostgresqlConnection() { PQfinish(connection_); }

absl::StatusOr<std::unique_ptr<PostgresqlConnection>> PostgresqlConnection::Open(
    const std::string& url, const std::string& schema) {
  std::unique_ptr<PostgresqlConnection> connection(
      new PostgresqlConnection(schema, PQconnectdb(url.c_str())));
  if (connection->lost()) {
    return PeerUnavailable("PostgreSQL", Trimmed(PQerrorMessage(connection->connection_)));
  }
  MORTISE_RETURN_IF_ERROR(connection->UseSchema());
  return connection;
}

bool PostgresqlConnection::lost() const {
  return broken_ || PQstatus(connection_) != CONNECTION_OK;
}

absl::Status PostgresqlConnection::UseSchema() {
  PQsetNoticeProcessor(
      connection_, [](void*, const char*) {}, nullptr);  // "exists, skipping"
  PQsetClientEncoding(connection_, "UTF8");
  // Index scans lock few rows against serialization failures; sequential ones the whole table. Of
  // fresh tables the server knows no sizes: it would sort all that waits for the sake of the next.
  // What is asked here takes less time than to compile it.
  return Execute(
      absl::StrCat("SET search_path TO \"", schema_,
                   "\"; SET enable_seqscan = off; SET enable_sort = off; SET jit = off"));
}

absl::Status PostgresqlConnection::Reconnect() {
  prepared_.clear();
  PQreset(connection_);
  broken_ = false;
  if (lost()) return PeerUnavailable("PostgreSQL", Trimmed(PQerrorMessage(connection_)));
  return UseSchema();
}

absl::Status PostgresqlConnection::Failure(const pg_result* result) {
  const char* field = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const std::string_view state = field == nullptr ? "" : field;
  // The connection's own is gone once the rest of a pipeline was read.
  std::string message = Trimmed(PQresultErrorMessage(result));
  if (message.empty()) message = Trimmed(PQerrorMessage(connection_));
  broken_ = broken_ || state.empty();  // only the server's own failures have a state
  absl::Status status = StorageFailed("PostgreSQL", message);
  // Serialization failure, deadlock, and rows inserted by two at once.
  if (state == "40001" || state == "40P01" || state == "23505") {
    repeatable_ = true;
    status =
        PeerUnavailable("PostgreSQL", absl::StrCat("others kept getting in the way: ", message));
  } else if (lost() || state.starts_with("57P") || state.starts_with("53")) {
    repeatable_ = lost();
    status = PeerUnavailable("PostgreSQL", message);
  }
  if (failure_.ok()) failure_ = status;
  return status;
}

absl::Status PostgresqlConnection::Prepare(const char* sql, absl::Span<const SqlValue> values,
                                           std::string* name) {
  std::string& known = prepared_[sql];
  if (known.empty()) {
    const Parameters parameters(values);
    const std::string candidate = absl::StrCat("s", prepared_.size());
    Result result(
        PQprepare(connection_, candidate.c_str(), sql, parameters.size(), parameters.types()));
    if (!Succeeded(result.get())) {
      prepared_.erase(sql);
      return Failure(result.get());
    }
    known = candidate;
  }
  *name = known;
  return absl::OkStatus();
}

absl::StatusOr<SqlResult> PostgresqlConnection::Run(const char* sql,
                                                    absl::Span<const SqlValue> values) {
  if (!failure_.ok()) return failure_;  // the server refuses everything until the rollback
  std::string name;
  MORTISE_RETURN_IF_ERROR(Prepare(sql, values, &name));
  const Parameters parameters(values);
  if (begin_ != nullptr) return RunWithBegin(name, parameters);
  Result result(PQexecPrepared(connection_, name.c_str(), parameters.size(), parameters.data(),
                               parameters.lengths(), parameters.formats(), 1));
  if (!Succeeded(result.get())) return Failure(result.get());
  return ResultOf(result.get());
}

absl::StatusOr<SqlResult> PostgresqlConnection::RunWithBegin(const std::string& name,
                                                             const Parameters& parameters) {
  const char* const begin = std::exchange(begin_, nullptr);
  const bool is_sent =
      PQenterPipelineMode(connection_) == 1 &&
      PQsendQueryParams(connection_, begin, 0, nullptr, nullptr, nullptr, nullptr, 1) == 1 &&
      PQsendQueryPrepared(connection_, name.c_str(), parameters.size(), parameters.data(),
                          parameters.lengths(), parameters.formats(), 1) == 1 &&
      PQpipelineSync(connection_) == 1;
  if (!is_sent) return Failure(nullptr);
  const Result begun = NextResult(connection_), ran = NextResult(connection_);
  const Result end(PQgetResult(connection_));
  const bool is_at_end =
      PQresultStatus(end.get()) == PGRES_PIPELINE_SYNC && PQexitPipelineMode(connection_) == 1;
  if (!Succeeded(begun.get())) return Failure(begun.get());
  if (!Succeeded(ran.get())) return Failure(ran.get());
  if (!is_at_end) return Failure(nullptr);
  return ResultOf(ran.get());
}

absl::Status PostgresqlConnection::Execute(const std::string& sql) {
  if (begin_ != nullptr) {
    const Result begun(PQexec(connection_, std::exchange(begin_, nullptr)));
    if (!Succeeded(begun.get())) return Failure(begun.get());
  }
  Result result(PQexec(connection_, sql.c_str()));
  return Succeeded(result.get()) ? absl::OkStatus() : Failure(result.get());
}

absl::Status PostgresqlConnection::Begin(const char* begin) {
  failure_ = absl::OkStatus();
  repeatable_ = false;
  if (lost()) {
    if (absl::Status status = Reconnect(); !status.ok()) {
      repeatable_ = true;
      return status;
    }
  }
  begin_ = begin;
  return absl::OkStatus();
}

absl::Status PostgresqlConnection::Commit() {
  if (std::exchange(begin_, nullptr) != nullptr) return absl::OkStatus();  // nothing was done
  Result result(PQexec(connection_, "COMMIT"));
  if (Succeeded(result.get())) {
    if (std::string_view(PQcmdStatus(result.get())) == "COMMIT") return absl::OkStatus();
    return StorageFailed("PostgreSQL", "the transaction was rolled back in place of a commit");
  }
  absl::Status status = Failure(result.get());
  if (!lost()) return status;
  repeatable_ = false;
  return WithDetail(
      absl::UnavailableError("the connection to PostgreSQL was lost during a commit; whether it "
                             "happened is unknown, repeat the request with the same request id"),
      {"COMMIT_UNKNOWN", ""});
}

void PostgresqlConnection::Rollback() {
  begin_ = nullptr;
  if (lost() || PQtransactionStatus(connection_) == PQTRANS_IDLE) return;
  PQclear(PQexec(connection_, "ROLLBACK"));
}

}  // namespace mortise::store
