// Long-running operations: work that outlives the request, and the process, that started it.
//
// Starting an operation is part of the caller's transaction: the operation and the change it
// belongs to exist together or not at all. It runs after the commit, on a thread of its own pool,
// reports progress, can be cancelled, and saves checkpoints. If the process dies, the operation
// runs again from its last checkpoint: after a restart at once (Resume), or on another replica of
// the service when the lease has expired. Several replicas may share a store; each operation runs
// on one of them, and what a superseded run still tries to write is refused.
//
// Every change of state is an event in the store's outbox, with the operation's name as subject:
// operation.started, .progressed (at most one each `progress_interval`), .succeeded, .failed,
// .cancelled.
//
// The library knows nothing of protobuf: requests, results and checkpoints are opaque bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/store.h"

namespace mortise::operations {

// What callers attach to an operation, and to the resource that it makes, to find them by.
struct OperationTags {
  std::vector<std::string> external_ids = {};      // the numbers that other systems know it by
  std::map<std::string, std::string> labels = {};  // value by key
};

enum class OperationState { kPending, kRunning, kSucceeded, kFailed, kCancelled };

// "pending", "running", "succeeded", "failed", "cancelled".
const char* OperationStateName(OperationState state);

// Whether an operation in this state will never change again.
bool IsFinal(OperationState state);

// How far an operation is.
struct Progress {
  int64_t done = 0;          // of one that has succeeded `total`, if that is known
  int64_t total = 0;         // 0 if unknown
  double best_so_far = 0;    // meaning and unit are the kind's own
  bool has_best = false;     // whether best_so_far is set
  std::string message = {};  // a short sentence for people
};

struct Operation {
  std::string name = {};      // "operations/<service>/<id>"
  std::string kind = {};      // which handler runs it
  std::string subject = {};   // resource name it works on
  std::string trace_id = {};  // of the request that started it
  std::string creator = {};   // who asked for it
  std::string method = {};    // that was called to start it
  OperationTags tags = {};    // as the request that started it gave them
  OperationState state = OperationState::kPending;
  bool cancel_requested = false;
  Progress progress = {};
  std::string request = {};  // opaque bytes, as given to Start
  std::string result = {};   // opaque bytes, of kSucceeded, perhaps of kCancelled
  absl::Status error = {};   // of kFailed and kCancelled, with its details
  int64_t revision = 0;      // grows with every change
  absl::Time created_at = {};
  absl::Time updated_at = {};
};

// What Start needs to know.
struct NewOperation {
  std::string kind = {};
  std::string request = {};
  std::string subject = {};
  std::string trace_id = {};
  std::string creator = {};
  std::string method = {};
  OperationTags tags = {};
};

// Which operations to visit; what is empty excludes none.
struct OperationFilter {
  std::vector<OperationState> states = {};
  std::string kind = {};
  std::string subject = {};
  // Whether one that passes all of the above is visited. It sees the operation without request and
  // result, which are read only of those that it takes.
  std::function<bool(const Operation&)> takes = {};
};

// The handler's side of a running operation. All calls are thread safe.
class OperationContext {
 public:
  virtual ~OperationContext() = default;

  virtual const std::string& name() const = 0;
  virtual const std::string& request() const = 0;

  // Returns the operation as it was when this run began: who asked for it, with which tags.
  virtual const Operation& operation() const = 0;

  // Whether to stop: somebody cancelled it, the process shuts down, or another replica has taken
  // it over. Save a checkpoint if worthwhile and return absl::CancelledError(). Only in the first
  // case is the operation then cancelled; otherwise it resumes from the checkpoint.
  virtual bool Cancelled() const = 0;

  // The same for code that waits: a stop is requested when Cancelled() becomes true.
  virtual std::stop_token stop_token() const = 0;

  // Cheap: store, watchers and bus see the last call of each `progress_interval`, and always the
  // last of all.
  virtual void ReportProgress(const Progress& progress) = 0;

  // Keeps the best result so far: the operation's result should it be cancelled.
  virtual void KeepResult(std::string_view result) = 0;

  // Durably keeps `bytes` as the place to resume from. ABORTED, STALE_ATTEMPT if another replica
  // has taken the operation over.
  virtual absl::Status SaveCheckpoint(std::string_view bytes) = 0;

  // Returns the last checkpoint saved, by this run or an earlier one; empty if none.
  virtual const std::string& checkpoint() const = 0;

  // A transaction that commits only while this run still owns the operation (ABORTED,
  // STALE_ATTEMPT otherwise), so that effects are never those of a superseded run.
  virtual absl::Status Transact(const std::function<absl::Status(store::Transaction&)>& change) = 0;

  // The same, and saves `checkpoint` in the same transaction: effect and progress together.
  virtual absl::Status TransactWithCheckpoint(
      const std::function<absl::Status(store::Transaction&)>& change,
      std::string_view checkpoint) = 0;
};

// Runs an operation: returns the result, or why it failed. May run more than once (see above).
using OperationHandler = std::function<absl::StatusOr<std::string>(OperationContext&)>;

// What else becomes cancelled with an operation that nobody runs just now, in the transaction that
// cancels it: a handler that does not run cannot see to it.
using CancelWithOperation = std::function<absl::Status(store::Transaction&, const Operation&)>;

// What an event about an operation carries as payload.
using DescribeOperation = std::function<std::string(const Operation&)>;

struct OperationsOptions {
  std::string service = {};  // the middle part of the names
  // Who holds the leases. Distinct for each replica, the same after a restart of that replica.
  std::string owner = "main";
  int threads = 2;  // operations that run at the same time
  absl::Duration lease = absl::Seconds(30);
  // A run whose process dies counts; after this many the operation fails instead of killing again.
  int max_attempts = 10;
  absl::Duration progress_interval = absl::Milliseconds(200);
  // How soon changes made by other replicas are noticed.
  absl::Duration poll = absl::Milliseconds(500);
  // Unset: a JSON object with kind, state, done, total, best, message and error.
  DescribeOperation describe = {};
};

// Stops a watch when it goes away; no callback runs once its destructor has returned.
class OperationWatch {
 public:
  virtual ~OperationWatch() = default;
};

class Operations {
 public:
  // `store` must outlive it.
  static absl::StatusOr<std::unique_ptr<Operations>> Create(const OperationsOptions& options,
                                                            store::Store* store);

  // Asks running handlers to stop, waits for them, and leaves what is unfinished to be resumed.
  virtual ~Operations() = default;

  // Names the handler of a kind. Before Resume.
  virtual void Register(const std::string& kind, OperationHandler handler,
                        CancelWithOperation cancel_with = {}) = 0;

  // Begins to run operations: those left unfinished by this owner's last process at once, then new
  // ones. Call once, after the Registers. Operations of kinds that are not registered stay pending.
  virtual absl::Status Resume() = 0;

  // Creates an operation in the caller's transaction. INVALID_ARGUMENT for a kind that is not
  // registered.
  virtual absl::StatusOr<Operation> Start(store::Transaction& transaction,
                                          const NewOperation& operation) = 0;

  // NOT_FOUND; INVALID_ARGUMENT for a name that is not of this service.
  virtual absl::StatusOr<Operation> Get(std::string_view name) = 0;

  // Operations, newest first, at most `limit`, beyond the operation named `after_name` (empty: from
  // the newest).
  virtual absl::StatusOr<std::vector<Operation>> List(std::string_view after_name, int limit) = 0;

  // Shows a visitor those that pass the filter, newest first, beyond the operation named
  // `after_name`, until it returns false. They come one by one, as results may be large. `begin`
  // makes the visitor: again, for all to be shown anew, where the database was lost on the way.
  // Neither may use the Operations.
  using Visitor = std::function<bool(const Operation&)>;
  virtual absl::Status Visit(std::string_view after_name, const OperationFilter& filter,
                             const std::function<Visitor()>& begin) = 0;

  // Asks an operation to stop; a pending one is cancelled at once. Returns it as it then is. No
  // effect on a finished one.
  virtual absl::StatusOr<Operation> Cancel(std::string_view name) = 0;

  // Waits for the end. At `deadline` returns the operation as it is.
  virtual absl::StatusOr<Operation> Wait(std::string_view name, absl::Time deadline) = 0;

  // Calls `callback` with the operation as it is now, then on every change until it is final (that
  // one always included, progress at least to its last value), one call at a time. The callback
  // must be quick, must not use the Operations, and must not destroy its watch. The Operations
  // must outlive the watch.
  virtual absl::StatusOr<std::unique_ptr<OperationWatch>> Watch(
      std::string_view name, std::function<void(const Operation&)> callback) = 0;
};

}  // namespace mortise::operations
