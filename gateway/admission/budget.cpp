#include "gateway/admission/budget.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

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

absl::Status TooManyAtATime(std::string_view what) {
  const std::string words(what);
  return WithDetail(
      absl::ResourceExhaustedError(absl::StrCat("too many ", words, " at a time; try again later")),
      {"TOO_MANY_CALLS", words});
}

}  // namespace mortise::gateway
