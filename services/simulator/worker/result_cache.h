// Keeps results of evaluations by what they depend on, the least recently used forgotten first.
#pragma once

#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

namespace mortise::simulator {

// Thread safe.
class ResultCache {
 public:
  // Keeps at most `capacity` results.
  explicit ResultCache(std::size_t capacity) : capacity_(capacity) {}

  // Returns the result stored under `key`; absent if unknown or forgotten.
  std::optional<std::string> Find(const std::string& key);

  void Store(const std::string& key, std::string result);

  std::size_t size() const;

 private:
  using Entry = std::pair<std::string, std::string>;  // key, result
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;                                           // guarded; latest first
  std::unordered_map<std::string, std::list<Entry>::iterator> index_;  // guarded
};

}  // namespace mortise::simulator
