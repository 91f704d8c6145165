// One connection writes, under a mutex; a pool of others reads, each on its own snapshot (WAL).
#include "common/store/sqlite_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/store/commit_listeners.h"
#include "common/store/connection_pool.h"
#include "common/store/nesting_guard.h"
#include "common/store/schema.h"
#include "common/store/sql_transaction.h"
#include "common/store/sqlite_connection.h"

namespace mortise::store {
namespace {

const SchemaDialect kDialect{.bytes = "BLOB",
                             .text = "TEXT",
                             .number = "INTEGER",
                             .identity = "INTEGER PRIMARY KEY AUTOINCREMENT"};

// Rolls back unless committed, also when `change` throws.
class OpenTransaction {
 public:
  explicit OpenTransaction(SqliteConnection* connection) : connection_(connection) {}
  ~OpenTransaction() { connection_->Rollback(); }
  OpenTransaction(const OpenTransaction&) = delete;
  OpenTransaction& operator=(const OpenTransaction&) = delete;

  absl::Status Finish(const absl::Status& status) {
    if (!connection_->failure().ok()) return connection_->failure();
    return status.ok() ? connection_->Commit() : status;
  }

 private:
  SqliteConnection* connection_;
};

// An exclusive lock on a file, held until destroyed or until the process dies.
class FileLock {
 public:
  static absl::StatusOr<FileLock> Take(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0) return StorageFailed(path.string(), std::strerror(errno));
    FileLock lock(descriptor);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      return PreconditionFailed("RELAY_TAKEN", "another relay numbers the events of this store",
                                path.string());
    }
    return lock;
  }

  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

 private:
  int descriptor_;
};

class SqliteStore final : public Store {
 public:
  SqliteStore(const StoreOptions& options, std::filesystem::path path,
              std::unique_ptr<SqliteConnection> writer, std::unique_ptr<BlobFolder> blobs)
      : clock_(options.clock),
        path_(path),
        writer_(std::move(writer)),
        readers_(options.connections,
                 [path] { return SqliteConnection::Open(path, SqliteConnection::Use::kRead); }),
        blobs_(std::move(blobs)) {}

  absl::Status Transact(const std::function<absl::Status(Transaction&)>& change,
                        Isolation) override {
    std::vector<std::function<void()>> callbacks;
    bool wakes_listeners = false;
    MORTISE_RETURN_IF_ERROR(Write([&](SqliteConnection* connection) {
      SqlTransaction transaction(connection, clock_());
      absl::Status status = change(transaction);
      callbacks = transaction.TakeCallbacks();
      wakes_listeners = transaction.wakes_listeners();
      return status;
    }));
    for (const auto& callback : callbacks) callback();
    if (wakes_listeners) listeners_.Notify();
    return absl::OkStatus();
  }

  absl::Status Read(const std::function<absl::Status(ReadTransaction&)>& read) override {
    MORTISE_ASSIGN_OR_RETURN(auto connection, readers_.Take());
    MORTISE_RETURN_IF_ERROR(connection->Begin());
    OpenTransaction open(connection.get());
    SqlTransaction transaction(connection.get(), clock_());
    return open.Finish(read(transaction));
  }

  absl::StatusOr<std::unique_ptr<EventNumbering>> TakeEventNumbering() override;

  std::unique_ptr<CommitListener> OnCommit(std::function<void()> callback) override {
    return listeners_.Add(std::move(callback));
  }

  absl::StatusOr<BlobFolder*> Blobs() override {
    if (blobs_ != nullptr) return blobs_.get();
    return PreconditionFailed("NO_BLOB_FOLDER", "the store was opened without a blob folder");
  }

  absl::Time Now() const override { return clock_(); }

  // Runs `change` on the writing connection, in a transaction.
  absl::Status Write(const std::function<absl::Status(SqliteConnection*)>& change) {
    NestingGuard guard(&threads_);
    if (guard.nested()) {
      return PreconditionFailed("TRANSACTION_NESTED", "transactions do not nest");
    }
    std::lock_guard lock(mutex_);
    MORTISE_RETURN_IF_ERROR(writer_->Begin());
    OpenTransaction open(writer_.get());
    return open.Finish(change(writer_.get()));
  }

 private:
  Clock clock_;
  std::filesystem::path path_;
  TransactingThreads threads_;
  std::mutex mutex_;
  std::unique_ptr<SqliteConnection> writer_;  // guarded by mutex_
  ConnectionPool<SqliteConnection> readers_;
  CommitListeners listeners_;
  std::unique_ptr<BlobFolder> blobs_;
};

class SqliteEventNumbering final : public EventNumbering {
 public:
  SqliteEventNumbering(SqliteStore* store, FileLock lock, int64_t epoch)
      : store_(store), lock_(std::move(lock)), epoch_(epoch) {}

  int64_t epoch() const override { return epoch_; }

  absl::StatusOr<std::vector<NumberedEvent>> NumberEvents(int limit) override {
    std::vector<NumberedEvent> events;
    MORTISE_RETURN_IF_ERROR(store_->Write([&](SqliteConnection* connection) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(events, EventTable(connection).Number(epoch_, limit));
      return absl::OkStatus();
    }));
    return events;
  }

 private:
  SqliteStore* store_;
  FileLock lock_;
  int64_t epoch_;
};

absl::StatusOr<std::unique_ptr<EventNumbering>> SqliteStore::TakeEventNumbering() {
  MORTISE_ASSIGN_OR_RETURN(FileLock lock, FileLock::Take(path_.string() + "-relay"));
  int64_t epoch = 0;
  MORTISE_RETURN_IF_ERROR(Write([&](SqliteConnection* connection) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(epoch, EventTable(connection).BeginEpoch(clock_()));
    return absl::OkStatus();
  }));
  return std::make_unique<SqliteEventNumbering>(this, std::move(lock), epoch);
}

absl::Status CreateFolder(const std::filesystem::path& folder) {
  if (folder.empty()) return absl::OkStatus();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return StorageFailed(folder.string(), "the folder cannot be created: " + error.message());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> OpenSqliteStore(const std::filesystem::path& path,
                                                       const StoreOptions& options,
                                                       std::unique_ptr<BlobFolder> blobs) {
  MORTISE_RETURN_IF_ERROR(CreateFolder(path.parent_path()));
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<SqliteConnection> writer,
                           SqliteConnection::Open(path, SqliteConnection::Use::kWrite));
  auto store = std::make_unique<SqliteStore>(options, path, std::move(writer), std::move(blobs));
  MORTISE_RETURN_IF_ERROR(store->Write([&](SqliteConnection* connection) {
    return PrepareSchema(kDialect, options.clock(), connection);
  }));
  return store;
}

}  // namespace mortise::store
