// Every transaction and every read takes a connection from a pool. Transactions that meet one
// another are rolled back by the server and run again here.
#include "common/store/postgresql_store.h"

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/store/commit_listeners.h"
#include "common/store/connection_pool.h"
#include "common/store/nesting_guard.h"
#include "common/store/postgresql_connection.h"
#include "common/store/schema.h"
#include "common/store/sql_transaction.h"

namespace mortise::store {
namespace {

const SchemaDialect kDialect{.bytes = "BYTEA",
                             .text = "TEXT COLLATE \"C\"",
                             .number = "BIGINT",
                             .identity = "BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY"};

const char* BeginOf(Isolation isolation) {
  return isolation == Isolation::kSerializable ? "BEGIN ISOLATION LEVEL SERIALIZABLE"
                                               : "BEGIN ISOLATION LEVEL READ COMMITTED";
}

using Change = std::function<absl::Status(PostgresqlConnection*)>;

// Rolls back unless committed, also when `change` throws.
class OpenTransaction {
 public:
  explicit OpenTransaction(PostgresqlConnection* connection) : connection_(connection) {}
  ~OpenTransaction() { connection_->Rollback(); }
  OpenTransaction(const OpenTransaction&) = delete;
  OpenTransaction& operator=(const OpenTransaction&) = delete;

  absl::Status Run(const Change& change) {
    absl::Status status = change(connection_);
    if (!connection_->failure().ok()) return connection_->failure();
    return status.ok() ? connection_->Commit() : status;
  }

 private:
  PostgresqlConnection* connection_;
};

absl::Status RunOnce(PostgresqlConnection* connection, const char* begin, const Change& change) {
  MORTISE_RETURN_IF_ERROR(connection->Begin(begin));
  return OpenTransaction(connection).Run(change);
}

// Repeats the transaction, ever later, while others get in its way, for as long as `patience`.
absl::Status RunPatiently(PostgresqlConnection* connection, const char* begin,
                          absl::Duration patience, const Change& change) {
  const absl::Time deadline = absl::Now() + patience;
  std::optional<std::minstd_rand> random;  // seldom needed, and costly
  double pause = 0.5;                      // milliseconds, doubled up to 100
  while (true) {
    absl::Status status = RunOnce(connection, begin, change);
    if (status.ok() || !connection->repeatable() || absl::Now() > deadline) return status;
    if (!random) random.emplace(std::random_device{}());
    absl::SleepFor(absl::Milliseconds(std::uniform_real_distribution<>(0, pause)(*random)));
    pause = std::min(2 * pause, 100.0);
  }
}

class PostgresqlStore final : public Store {
 public:
  PostgresqlStore(const StoreOptions& options, std::unique_ptr<BlobFolder> blobs)
      : options_(options),
        writers_(options.connections, [this] { return Connect(); }),
        readers_(options.connections, [this] { return Connect(); }),
        blobs_(std::move(blobs)) {}

  // Creates schema and tables, one replica at a time.
  absl::Status Prepare() {
    MORTISE_ASSIGN_OR_RETURN(auto connection, writers_.Take());
    return RunPatiently(connection.get(), BeginOf(Isolation::kReadCommitted), options_.patience,
                        [&](PostgresqlConnection* open) -> absl::Status {
                          MORTISE_RETURN_IF_ERROR(open->Execute(
                              "SELECT pg_advisory_xact_lock(hashtext('mortise schema'))"));
                          MORTISE_RETURN_IF_ERROR(open->Execute(absl::StrCat(
                              "CREATE SCHEMA IF NOT EXISTS \"", options_.service, "\"")));
                          return PrepareSchema(kDialect, options_.clock(), open);
                        });
  }

  absl::Status Transact(const std::function<absl::Status(Transaction&)>& change,
                        Isolation isolation) override {
    NestingGuard guard(&threads_);
    if (guard.nested()) {
      return PreconditionFailed("TRANSACTION_NESTED", "transactions do not nest");
    }
    std::vector<std::function<void()>> callbacks;
    bool wakes_listeners = false;
    MORTISE_RETURN_IF_ERROR(Run(isolation, [&](PostgresqlConnection* connection) {
      SqlTransaction transaction(connection, options_.clock());
      absl::Status status = change(transaction);
      callbacks = transaction.TakeCallbacks();
      wakes_listeners = transaction.wakes_listeners();
      return status;
    }));
    guard.Leave();
    for (const auto& callback : callbacks) callback();
    if (wakes_listeners) listeners_.Notify();
    return absl::OkStatus();
  }

  absl::Status Read(const std::function<absl::Status(ReadTransaction&)>& read) override {
    MORTISE_ASSIGN_OR_RETURN(auto connection, readers_.Take());
    return RunPatiently(connection.get(), "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY",
                        options_.patience, [&](PostgresqlConnection* open) {
                          SqlTransaction transaction(open, options_.clock());
                          return read(transaction);
                        });
  }

  absl::StatusOr<std::unique_ptr<EventNumbering>> TakeEventNumbering() override;

  std::unique_ptr<CommitListener> OnCommit(std::function<void()> callback) override {
    return listeners_.Add(std::move(callback));
  }

  absl::StatusOr<BlobFolder*> Blobs() override {
    if (blobs_ != nullptr) return blobs_.get();
    return PreconditionFailed("NO_BLOB_FOLDER", "the store was opened without a blob folder");
  }

  absl::Time Now() const override { return options_.clock(); }

  absl::StatusOr<std::unique_ptr<PostgresqlConnection>> Connect() {
    return PostgresqlConnection::Open(options_.url, options_.service);
  }

 private:
  absl::Status Run(Isolation isolation, const Change& change) {
    MORTISE_ASSIGN_OR_RETURN(auto connection, writers_.Take());
    return RunPatiently(connection.get(), BeginOf(isolation), options_.patience, change);
  }

  StoreOptions options_;
  TransactingThreads threads_;
  ConnectionPool<PostgresqlConnection> writers_;
  ConnectionPool<PostgresqlConnection> readers_;
  CommitListeners listeners_;
  std::unique_ptr<BlobFolder> blobs_;
};

// Holds an advisory lock, which the server frees when the connection ends: after a death in its own
// time, so the destructor gives it back for another to have it at once. Should the connection
// be lost and the lock with it, the epoch tells: whoever takes over begins a new one, and numbers
// are only given under the present epoch.
class PostgresqlEventNumbering final : public EventNumbering {
 public:
  PostgresqlEventNumbering(std::unique_ptr<PostgresqlConnection> connection, int64_t epoch,
                           absl::Duration patience)
      : connection_(std::move(connection)), epoch_(epoch), patience_(patience) {}

  ~PostgresqlEventNumbering() override {
    // Failing it changes nothing: the connection is lost, and the lock with it.
    connection_->Execute("SELECT pg_advisory_unlock_all()").IgnoreError();
  }

  int64_t epoch() const override { return epoch_; }

  absl::StatusOr<std::vector<NumberedEvent>> NumberEvents(int limit) override {
    std::vector<NumberedEvent> events;
    MORTISE_RETURN_IF_ERROR(RunPatiently(
        connection_.get(), "BEGIN ISOLATION LEVEL REPEATABLE READ", patience_,
        [&](PostgresqlConnection* connection) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(events, EventTable(connection).Number(epoch_, limit));
          return absl::OkStatus();
        }));
    return events;
  }

 private:
  std::unique_ptr<PostgresqlConnection> connection_;
  int64_t epoch_;
  absl::Duration patience_;
};

absl::StatusOr<std::unique_ptr<EventNumbering>> PostgresqlStore::TakeEventNumbering() {
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<PostgresqlConnection> connection, Connect());
  bool locked = false;
  int64_t epoch = 0;
  MORTISE_RETURN_IF_ERROR(
      RunOnce(connection.get(), BeginOf(Isolation::kReadCommitted),
              [&](PostgresqlConnection* open) -> absl::Status {
                MORTISE_ASSIGN_OR_RETURN(
                    SqlResult lock,
                    open->Run("SELECT CAST(CAST(pg_try_advisory_lock("
                              "hashtext('mortise events'), hashtext($1)) AS INT) AS BIGINT)",
                              {options_.service}));
                locked = lock.rows.size() == 1 && lock.rows[0][0].integer == 1;
                if (!locked) return absl::OkStatus();
                MORTISE_ASSIGN_OR_RETURN(epoch, EventTable(open).BeginEpoch(options_.clock()));
                return absl::OkStatus();
              }));
  if (!locked) {
    return PreconditionFailed("RELAY_TAKEN", "another relay numbers the events of this store");
  }
  return std::make_unique<PostgresqlEventNumbering>(std::move(connection), epoch,
                                                    options_.patience);
}

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> OpenPostgresqlStore(const StoreOptions& options,
                                                           std::unique_ptr<BlobFolder> blobs) {
  auto store = std::make_unique<PostgresqlStore>(options, std::move(blobs));
  MORTISE_RETURN_IF_ERROR(store->Prepare());
  return store;
}

}  // namespace mortise::store
