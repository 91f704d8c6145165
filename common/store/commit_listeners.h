// Who wants to know of commits.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "common/store/store.h"

namespace mortise::store {

// Thread safe. A listener's destructor waits for its callback to return.
class CommitListeners {
 public:
  std::unique_ptr<CommitListener> Add(std::function<void()> callback);
  void Notify();

 private:
  class Registration;

  std::mutex mutex_;
  int64_t last_ = 0;                                    // guarded by mutex_
  std::map<int64_t, std::function<void()>> callbacks_;  // guarded by mutex_
};

}  // namespace mortise::store
