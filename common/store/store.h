// Durable records, outbox and task queue behind one interface, with two drivers: SQLite (one file,
// nothing to run) and PostgreSQL (shared by replicas).
//
// All changes happen in transactions, which run as if one after the other. A service changes its
// records, tells of the change and queues the work that follows in one of them:
//
//   absl::Status status = store->Transact([&](store::Transaction& transaction) -> absl::Status {
//     MORTISE_ASSIGN_OR_RETURN(auto revision,
//                              transaction.Put("designs", id, bytes, {.expected_revision = 3}));
//     return transaction.AppendEvent({.type = "design.updated", .subject = name});
//   });
//
// Names (kind, key, queue, worker, type, subject, trace id) are valid UTF-8 of at most 1024 bytes
// without control characters; kind, key, queue and type are not empty. Otherwise INVALID_ARGUMENT.
// Payloads, results and errors are any bytes, at most 64 MiB (RESOURCE_EXHAUSTED); past 1 MiB a
// blob is the better place. Failures of the database are INTERNAL, reason STORAGE_FAILED.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/store/blob_folder.h"
#include "common/store/types.h"

namespace mortise::store {

struct StoreOptions {
  // "sqlite:/path/catalog.db", or a libpq connection string "postgresql://user@host/database".
  std::string url = {};
  // Where blobs live; empty if the caller stores none. Created if missing.
  std::filesystem::path blob_folder = {};
  // The service whose store this is. On PostgreSQL its tables live in a schema of this name, so
  // that services can share a database. A resource id: lower-case letters, digits, hyphens.
  std::string service = "mortise";
  // How many reads and, on PostgreSQL, transactions run at the same time.
  int connections = 4;
  // How long a transaction that others get in the way of is repeated (PostgreSQL).
  absl::Duration patience = absl::Seconds(15);
  Clock clock = absl::Now;
};

// What can be read. All reads of one transaction see the same state.
class ReadTransaction {
 public:
  virtual ~ReadTransaction() = default;

  // Returns the current revision; NOT_FOUND naming "kind/key".
  virtual absl::StatusOr<Record> Get(std::string_view kind, std::string_view key) = 0;

  // Returns the revision asked for, if it is the current one or was kept; NOT_FOUND otherwise.
  virtual absl::StatusOr<Record> GetRevision(std::string_view kind, std::string_view key,
                                             int64_t revision) = 0;

  // Records of a kind in the order of their keys.
  virtual absl::StatusOr<std::vector<Record>> List(std::string_view kind,
                                                   const ListOptions& options) = 0;

  // Numbered events after `after_number`, at most `limit`, in order, none missing. Events that the
  // relay has not numbered yet are not seen.
  virtual absl::StatusOr<std::vector<NumberedEvent>> ReadEvents(int64_t after_number,
                                                                int limit) = 0;

  // Returns the number of the last numbered event; 0 if none.
  virtual absl::StatusOr<int64_t> LatestEventNumber() = 0;

  // Returns the present epoch of the event stream; 0 before the first relay.
  virtual absl::StatusOr<int64_t> Epoch() = 0;

  // NOT_FOUND naming "queue/key".
  virtual absl::StatusOr<Task> GetTask(std::string_view queue, std::string_view key) = 0;

  // Tasks of a queue in the order of their keys.
  virtual absl::StatusOr<std::vector<Task>> ListTasks(std::string_view queue,
                                                      const ListOptions& options) = 0;

  virtual absl::StatusOr<QueueDepth> Depth(std::string_view queue) = 0;
};

// What can be changed. Nothing is visible to others before the commit.
class Transaction : public ReadTransaction {
 public:
  // Writes a record and returns its new revision. ABORTED, STALE_REVISION if
  // options.expected_revision is not the present one.
  virtual absl::StatusOr<int64_t> Put(std::string_view kind, std::string_view key,
                                      std::string_view payload, const PutOptions& options = {}) = 0;

  // Removes a record and its kept revisions. NOT_FOUND; ABORTED, STALE_REVISION.
  virtual absl::Status Delete(std::string_view kind, std::string_view key,
                              std::optional<int64_t> expected_revision = std::nullopt) = 0;

  // Puts an event into the outbox. The relay numbers and publishes it after the commit.
  virtual absl::Status AppendEvent(const NewEvent& event) = 0;

  // Queues a task. ALREADY_EXISTS if the queue has, or ever had, a task with this key.
  virtual absl::Status EnqueueTask(const NewTask& task) = 0;

  // Queues, in their order, those that EnqueueTask would; whether each is one of them. Many take
  // little longer than one.
  virtual absl::StatusOr<std::vector<bool>> EnqueueTasks(const std::vector<NewTask>& tasks) = 0;

  // Leases up to `limit` tasks to `worker` for `lease`: queued ones, and leased ones whose lease
  // has expired. Each lease raises the task's attempt. A worker does what it holds in the order in
  // which it leased it: where several leases of one run out, the attempt counts for the first, the
  // others were held in reserve. Expired tasks without attempts left become quarantined instead. No
  // task is leased to two workers at once. A limit of 0 only looks for expired ones.
  virtual absl::StatusOr<LeaseResult> LeaseTasks(std::string_view queue, std::string_view worker,
                                                 int limit, absl::Duration lease) = 0;

  // Extends the present lease to now + `lease`. ABORTED, STALE_ATTEMPT if the task was leased again
  // since; FAILED_PRECONDITION, TASK_CANCELLED or TASK_FINISHED: the worker should stop.
  virtual absl::Status RenewLease(std::string_view queue, std::string_view key, int64_t attempt,
                                  absl::Duration lease) = 0;

  // Records the result, and gives the task as it is then. Repeating it for the same attempt is OK
  // and changes nothing. Fails as RenewLease does. A late result of an attempt that nobody replaced
  // is accepted.
  virtual absl::StatusOr<Task> CompleteTask(std::string_view queue, std::string_view key,
                                            int64_t attempt, std::string_view result) = 0;

  // Records an error. With `retry`, and attempts left, the task is queued again and becomes due
  // after `delay`; otherwise it has failed. Fails as RenewLease does.
  virtual absl::Status FailTask(std::string_view queue, std::string_view key, int64_t attempt,
                                std::string_view error, bool retry,
                                absl::Duration delay = absl::ZeroDuration()) = 0;

  // Gives a leased task back unharmed: queued, due at once, this attempt not counted against
  // max_attempts. For workers that shut down. Fails as RenewLease does.
  virtual absl::Status ReleaseTask(std::string_view queue, std::string_view key,
                                   int64_t attempt) = 0;

  // Makes the tasks that `worker` holds due at once, their attempts counted: for a worker that
  // restarts under its old name. Returns how many.
  virtual absl::StatusOr<int64_t> ExpireLeases(std::string_view queue, std::string_view worker) = 0;

  // Cancels a queued or leased task; no effect on a cancelled one. FAILED_PRECONDITION,
  // TASK_FINISHED otherwise.
  virtual absl::Status CancelTask(std::string_view queue, std::string_view key) = 0;

  // Forgets a task that is neither queued nor leased (FAILED_PRECONDITION, TASK_UNFINISHED).
  virtual absl::Status DeleteTask(std::string_view queue, std::string_view key) = 0;

  // Runs `callback` after this transaction has committed, on the same thread; never if it rolls
  // back or is repeated.
  virtual void AfterCommit(std::function<void()> callback) = 0;

  // Returns the clock's time when the transaction began; one transaction has one time.
  virtual absl::Time Now() const = 0;
};

// How far transactions are kept apart.
enum class Isolation {
  // As if one after the other: what was read is still true at the commit.
  kSerializable,
  // Rows are locked as they are changed, but reads may see what others commit meanwhile. For
  // transactions made of queue calls alone, which lock what they take. (SQLite: as above.)
  kReadCommitted,
};

// The right to number the events of a store. At most one exists at a time, over all processes; the
// right of a dead process passes on.
class EventNumbering {
 public:
  virtual ~EventNumbering() = default;

  // Returns the epoch that began when this right was taken.
  virtual int64_t epoch() const = 0;

  // Gives up to `limit` committed events the next numbers, durably, and returns them. Empty if
  // there are none. ABORTED, reason RELAY_SUPERSEDED if another relay has taken over.
  virtual absl::StatusOr<std::vector<NumberedEvent>> NumberEvents(int limit) = 0;
};

// Stops a commit listener when it goes away.
class CommitListener {
 public:
  virtual ~CommitListener() = default;
};

class Store {
 public:
  virtual ~Store() = default;

  // Runs `change` in one transaction and commits if it returns OK; rolls back and returns its
  // status otherwise. Where others get in the way (busy, serialization failure, deadlock) the
  // transaction is rolled back and `change` runs again, so it must have no effects elsewhere; use
  // AfterCommit for those. UNAVAILABLE if the database stays busy or away. Transactions do not
  // nest: FAILED_PRECONDITION, TRANSACTION_NESTED.
  virtual absl::Status Transact(const std::function<absl::Status(Transaction&)>& change,
                                Isolation isolation = Isolation::kSerializable) = 0;

  // Runs `read` on one consistent state and returns its status. Does not wait for writers. Where
  // the database is lost on the way `read` runs again, on a newer state, so what it gathers it must
  // gather anew.
  virtual absl::Status Read(const std::function<absl::Status(ReadTransaction&)>& read) = 0;

  // Takes the right to number events and begins a new epoch. FAILED_PRECONDITION, reason
  // RELAY_TAKEN while another one holds it. The store must outlive it.
  virtual absl::StatusOr<std::unique_ptr<EventNumbering>> TakeEventNumbering() = 0;

  // Calls `callback` after each commit made through this object that wrote events or queued tasks.
  // It must be quick, and must not use the store. The store must outlive the listener.
  virtual std::unique_ptr<CommitListener> OnCommit(std::function<void()> callback) = 0;

  // Returns the blob folder; FAILED_PRECONDITION, NO_BLOB_FOLDER if the options named none.
  virtual absl::StatusOr<BlobFolder*> Blobs() = 0;

  // Returns the clock the store was opened with.
  virtual absl::Time Now() const = 0;
};

// Opens a store and creates or upgrades its tables. INVALID_ARGUMENT for a URL of neither form;
// INTERNAL, STORAGE_FAILED naming the path if the folder cannot be written or the disk is full;
// UNAVAILABLE if the PostgreSQL server cannot be reached.
absl::StatusOr<std::unique_ptr<Store>> OpenStore(const StoreOptions& options);

}  // namespace mortise::store
