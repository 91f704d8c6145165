#include "gateway/budget.h"

namespace mortise::gateway {

std::unique_ptr<Budget::Share> Budget::Take(const std::string& who, int64_t amount) {
  {
    std::lock_guard lock(mutex_);
    const auto found = taken_by_.find(who);
    const int64_t own = found == taken_by_.end() ? 0 : found->second;
    if (taken_ + amount > of_all_ || own + amount > of_each_) return nullptr;
    taken_ += amount;
    taken_by_[who] += amount;
  }
  return std::make_unique<Share>(*this, who, amount);
}

void Budget::GiveBack(const std::string& who, int64_t amount) {
  std::lock_guard lock(mutex_);
  taken_ -= amount;
  const auto found = taken_by_.find(who);
  found->second -= amount;
  if (found->second == 0) taken_by_.erase(found);
}

}  // namespace mortise::gateway
