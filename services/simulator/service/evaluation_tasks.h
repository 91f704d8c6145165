// Evaluations as tasks in the store: queued once for each content, shared by all who ask, waited
// for.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/store/store.h"

namespace mortise::simulator {

// The queue of our own evaluator, in the store and in LeaseTasks.
inline constexpr char kSimulatorQueue[] = "simulator";

// Returns the key of an evaluator's task: its id, a dot and the digest of what is evaluated. Keys
// of our own tasks have no dot, so that a key, and with it a task's name, tells its queue.
std::string TaskKeyIn(const std::string& queue, const std::string& digest);

// Returns the queue of a task: "simulator", or "evaluators/{id}".
std::string QueueOf(const std::string& key);

// Whether the task will not change any more.
bool IsFinished(const store::Task& task);

// Whether a failure may pass by itself, so that the work is worth another try.
bool IsTransient(const absl::Status& status);

struct WantedTask {
  std::string key;
  std::string payload;
  int priority = 0;
};

// A task that is in its queue, or has been.
struct FoundTask {
  std::optional<store::Task> finished;  // if it has
  bool known_before = false;            // it has a result that was computed before
};

// Whether a task that succeeded still has all that its result speaks of.
using IsWhole = std::function<bool(const store::Task& task)>;

// Returns the tasks under the keys, queued by this call if they were not there. Those that failed
// for a passing reason, for a limit of time or for want of OpenFOAM or Gmsh, were cancelled or are
// not whole any more, are queued afresh.
absl::StatusOr<std::vector<FoundTask>> FindOrEnqueue(store::Transaction& transaction,
                                                     const std::vector<WantedTask>& wanted,
                                                     const IsWhole& is_whole);

// Who waits for which task. Thread safe.
class TaskWaiters {
 public:
  // `known_before`: the result is older than the question.
  using Callback = std::function<void(const store::Task& task, bool known_before)>;

  // `callback` is called once with the finished task, on whichever thread learns of it.
  int64_t Add(const std::string& key, Callback callback);

  // Forgets a waiter; true if nobody else waits for its task.
  bool Remove(const std::string& key, int64_t ticket);

  bool IsAwaited(const std::string& key) const;

  // Hands a finished task to all who wait for it.
  void Notify(const store::Task& task, bool known_before);

  // Returns the tasks waited for, in ascending order.
  std::vector<std::string> Keys() const;

 private:
  mutable std::mutex mutex_;
  int64_t next_ticket_ = 1;                                       // guarded by mutex_
  std::map<std::string, std::map<int64_t, Callback>> callbacks_;  // guarded by mutex_
};

// Writes a status as bytes for the store's error column, and back; unknown bytes become INTERNAL.
std::string EncodeError(const absl::Status& status);
absl::Status DecodeError(const std::string& bytes);

// Returns why a finished task has no result; OK if it has.
absl::Status TaskError(const store::Task& task);

}  // namespace mortise::simulator
