#include "common/fem/linear/stage_progress.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::simulator {

void StageProgress::Expect(int stages) {
  const std::lock_guard lock(mutex_);
  total_ = stages;
}

void StageProgress::Begin(std::string stage) {
  const std::lock_guard lock(mutex_);
  stage_ = std::move(stage);
  iteration_ = 0;
  ++begun_;
}

void StageProgress::Iterate(int iteration) {
  const std::lock_guard lock(mutex_);
  iteration_ = iteration;
}

StageProgress::State StageProgress::state() const {
  const std::lock_guard lock(mutex_);
  const std::string stage =
      iteration_ > 0 ? absl::StrCat(stage_, ": iteration ", iteration_) : stage_;
  return {stage, std::min(std::max(begun_ - 1, 0), total_), total_};
}

}  // namespace mortise::simulator
