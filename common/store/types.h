// What a store holds: records, events and tasks, as plain structs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/time/time.h"

namespace mortise::store {

// Tells the time. Every time in a store comes from the clock it was opened with, so that tests can
// let a lease expire without waiting. Times are kept to the microsecond.
using Clock = std::function<absl::Time()>;

// ---- Records -----------------------------------------------------------------------------------

// A versioned value. `kind` is the collection ("templates"), `key` the name within it ("table").
struct Record {
  std::string kind = {};
  std::string key = {};
  int64_t revision = 0;      // 1 for the first Put, one more for each further Put
  std::string payload = {};  // opaque bytes
  absl::Time created_at = {};
  absl::Time updated_at = {};
};

struct PutOptions {
  // The revision this change is based on; 0 means the record must not exist yet. Unset overwrites.
  std::optional<int64_t> expected_revision = {};
  // Keeps the replaced revision, so that GetRevision still finds it.
  bool keep_history = false;
};

// Which records of a kind, or tasks of a queue, to list; they come in the order of their keys'
// bytes.
struct ListOptions {
  std::string after_key = {};   // only keys beyond this; the page token of List methods
  std::string key_prefix = {};  // only keys that start with this
  int limit = 100;              // at most this many, 1 to 10000
  bool descending = false;      // from the greatest key down (records only)
  // Leaves payloads empty, and where they are large unread, for those who only ask what there is
  // (records only).
  bool without_payloads = false;
};

// ---- Events ------------------------------------------------------------------------------------

// A fact to be told, written in the same transaction as the change it tells of.
struct NewEvent {
  std::string type = {};      // "design.created", "operation.succeeded"
  std::string subject = {};   // resource name: "designs/table-1"
  std::string payload = {};   // opaque bytes
  std::string trace_id = {};  // the request that caused it; empty if none
};

// An event with its place in the stream of its store: numbers are 1, 2, 3 … without gaps.
struct NumberedEvent {
  int64_t epoch = 0;     // grows with every takeover of the relay
  int64_t number = 0;    // counts from 1
  absl::Time time = {};  // when the transaction wrote it
  std::string type = {};
  std::string subject = {};
  std::string payload = {};
  std::string trace_id = {};
};

// ---- Tasks -------------------------------------------------------------------------------------

enum class TaskState {
  kQueued,       // waiting for a worker
  kLeased,       // a worker has it until lease_expires_at
  kSucceeded,    // result is set
  kFailed,       // a worker reported an error, and no attempts were left or it said not to retry
  kCancelled,    // by CancelTask
  kQuarantined,  // its workers vanished max_attempts times: the input may be what kills them
};

// Returns the name of a state in lower case ("queued").
const char* TaskStateName(TaskState state);

struct NewTask {
  std::string queue = {};
  std::string key = {};      // unique in its queue; the caller's, so that enqueuing can be repeated
  std::string payload = {};  // the input; kept whatever becomes of the task
  int max_attempts = 3;      // at least 1
  int priority = 0;          // higher first; equal priorities in order of arrival
};

struct Task {
  std::string queue = {};
  std::string key = {};
  std::string payload = {};
  TaskState state = TaskState::kQueued;
  int64_t attempt = 0;  // how often it was leased; the fencing token of the present lease
  int max_attempts = 3;
  int priority = 0;
  std::string worker = {};           // who leased it last
  absl::Time lease_expires_at = {};  // of the present or last lease
  std::string result = {};           // of kSucceeded
  std::string error = {};            // the last one reported, or why it is quarantined
  absl::Time created_at = {};
  absl::Time updated_at = {};
};

// What LeaseTasks did.
struct LeaseResult {
  std::vector<Task> leased = {};
  std::vector<Task> quarantined =
      {};  // found in this call to have lost their last attempt's worker
};

// How many tasks of a queue are in each state.
struct QueueDepth {
  int64_t queued = 0;
  int64_t leased = 0;
  int64_t succeeded = 0;
  int64_t failed = 0;
  int64_t cancelled = 0;
  int64_t quarantined = 0;
};

}  // namespace mortise::store
