#include "services/simulator/worker/result_cache.h"

namespace mortise::simulator {

std::optional<std::string> ResultCache::Find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = index_.find(key);
  if (found == index_.end()) return std::nullopt;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->second;
}

void ResultCache::Store(const std::string& key, std::string result) {
  const std::lock_guard lock(mutex_);
  const auto found = index_.find(key);
  if (found != index_.end()) {
    found->second->second = std::move(result);
    entries_.splice(entries_.begin(), entries_, found->second);
    return;
  }
  entries_.emplace_front(key, std::move(result));
  index_[key] = entries_.begin();
  if (entries_.size() <= capacity_) return;
  index_.erase(entries_.back().first);
  entries_.pop_back();
}

std::size_t ResultCache::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

}  // namespace mortise::simulator
