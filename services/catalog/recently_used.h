// What is costly to make, kept in the order of its use so that dragging a slider does not make it
// again at every move. Thread safe.
#pragma once

#include <algorithm>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace mortise::catalog {

// Values are copied out: let them be cheap to copy.
template <typename Value>
class RecentlyUsed {
 public:
  explicit RecentlyUsed(std::size_t capacity) : capacity_(capacity) {}

  std::optional<Value> Find(const std::string& key) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&key](const auto& entry) { return entry.first == key; });
    if (found == entries_.end()) return std::nullopt;
    entries_.splice(entries_.begin(), entries_, found);
    return found->second;
  }

  // Lets go of what was not used for longest.
  void Add(const std::string& key, Value value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.emplace_front(key, std::move(value));
    if (entries_.size() > capacity_) entries_.pop_back();
  }

 private:
  const std::size_t capacity_;
  std::mutex mutex_;
  std::list<std::pair<std::string, Value>> entries_;  // most recent first; guarded by mutex_
};

}  // namespace mortise::catalog
