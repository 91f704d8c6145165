// Who watches which operation.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "common/operations/operations.h"

namespace mortise::operations {

// Thread safe. Each watch sees ever newer revisions, one call at a time, up to the final one.
class OperationWatches {
 public:
  // Registers a watch; nothing is delivered before the first Notify.
  std::unique_ptr<OperationWatch> Add(const std::string& name,
                                      std::function<void(const Operation&)> callback);

  // Delivers `operation` to its watches that have not seen its revision yet.
  void Notify(const Operation& operation);

  // Returns the names of the operations that somebody watches and whose end he has not seen.
  std::set<std::string> Names();

 private:
  struct Watch {
    std::string name;
    std::function<void(const Operation&)> callback;
    std::mutex mutex;            // held during the callback
    bool closed = false;         // guarded by mutex
    bool finished = false;       // guarded by mutex
    int64_t last_revision = -1;  // guarded by mutex
  };
  class Registration;

  std::vector<std::shared_ptr<Watch>> All();
  void Remove(const std::shared_ptr<Watch>& watch);

  std::mutex mutex_;
  std::set<std::shared_ptr<Watch>> watches_;  // guarded by mutex_
};

}  // namespace mortise::operations
