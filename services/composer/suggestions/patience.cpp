#include "services/composer/suggestions/patience.h"

#include <algorithm>
#include <utility>

namespace mortise::composer {
namespace {

constexpr double kTelling = 0.1;  // of the time that is left at first
constexpr absl::Duration kLeastTelling = absl::Milliseconds(50);

}  // namespace

Patience::Patience(absl::Time deadline, std::function<absl::Time()> now)
    : now_(std::move(now)), end_(deadline) {
  if (deadline == absl::InfiniteFuture()) return;
  end_ -= std::max(kLeastTelling, kTelling * (deadline - now_()));
}

bool Patience::HasTimeForTrial() const { return now_() + longest_ < end_; }

bool Patience::IsOver() const { return now_() >= end_; }

void Patience::Try(const std::function<void()>& trial) {
  const absl::Time begin = now_();
  trial();
  longest_ = std::max(longest_, now_() - begin);
}

}  // namespace mortise::composer
