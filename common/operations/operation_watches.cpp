#include "common/operations/operation_watches.h"

#include <utility>

namespace mortise::operations {

class OperationWatches::Registration final : public OperationWatch {
 public:
  Registration(OperationWatches* watches, std::shared_ptr<Watch> watch)
      : watches_(watches), watch_(std::move(watch)) {}

  ~Registration() override {
    watches_->Remove(watch_);
    std::lock_guard lock(watch_->mutex);  // waits for a callback in progress
    watch_->closed = true;
  }

 private:
  OperationWatches* watches_;
  std::shared_ptr<Watch> watch_;
};

std::unique_ptr<OperationWatch> OperationWatches::Add(
    const std::string& name, std::function<void(const Operation&)> callback) {
  auto watch = std::make_shared<Watch>();
  watch->name = name;
  watch->callback = std::move(callback);
  std::lock_guard lock(mutex_);
  watches_.insert(watch);
  return std::make_unique<Registration>(this, std::move(watch));
}

std::vector<std::shared_ptr<OperationWatches::Watch>> OperationWatches::All() {
  std::lock_guard lock(mutex_);
  return {watches_.begin(), watches_.end()};
}

void OperationWatches::Remove(const std::shared_ptr<Watch>& watch) {
  std::lock_guard lock(mutex_);
  watches_.erase(watch);
}

void OperationWatches::Notify(const Operation& operation) {
  for (const std::shared_ptr<Watch>& watch : All()) {
    if (watch->name != operation.name) continue;
    std::lock_guard lock(watch->mutex);
    if (watch->closed || watch->finished || operation.revision <= watch->last_revision) continue;
    watch->last_revision = operation.revision;
    watch->finished = IsFinal(operation.state);
    watch->callback(operation);
  }
}

std::set<std::string> OperationWatches::Names() {
  std::set<std::string> names;
  for (const std::shared_ptr<Watch>& watch : All()) {
    std::lock_guard lock(watch->mutex);
    if (!watch->finished) names.insert(watch->name);
  }
  return names;
}

}  // namespace mortise::operations
