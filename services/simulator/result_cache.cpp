#include "services/simulator/result_cache.h"

#include <cstdint>

#include "common/base/digest.h"

namespace mortise::simulator {
namespace {

// Length before content, so that no two keys' texts can run into each other.
void Append(const std::string& text, std::string& bytes) {
  const std::uint64_t size = text.size();
  bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  bytes += text;
}

void Append(double value, std::string& bytes) {
  const double canonical = value == 0 ? 0.0 : value;  // −0 equals 0
  bytes.append(reinterpret_cast<const char*>(&canonical), sizeof canonical);
}

}  // namespace

std::string EvaluationKey(const std::string& subject_digest, const Eigen::VectorXd& parameters,
                          double element_size, bool linear, const std::string& what) {
  std::string bytes;
  Append(subject_digest, bytes);
  Append(what, bytes);
  Append(element_size, bytes);
  Append(linear ? 1.0 : 0.0, bytes);
  for (const double value : parameters) Append(value, bytes);
  return Sha256Hex(bytes);
}

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
