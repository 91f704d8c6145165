#include "common/store/commit_listeners.h"

#include <utility>

namespace mortise::store {

class CommitListeners::Registration final : public CommitListener {
 public:
  Registration(CommitListeners* listeners, int64_t id) : listeners_(listeners), id_(id) {}

  ~Registration() override {
    std::lock_guard lock(listeners_->mutex_);
    listeners_->callbacks_.erase(id_);
  }

 private:
  CommitListeners* listeners_;
  int64_t id_;
};

std::unique_ptr<CommitListener> CommitListeners::Add(std::function<void()> callback) {
  std::lock_guard lock(mutex_);
  callbacks_[++last_] = std::move(callback);
  return std::make_unique<Registration>(this, last_);
}

void CommitListeners::Notify() {
  std::lock_guard lock(mutex_);
  for (const auto& [id, callback] : callbacks_) callback();
}

}  // namespace mortise::store
