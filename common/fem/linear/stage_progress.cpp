#include "common/fem/linear/stage_progress.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::simulator {

void StageProgress::Expect(int stages) {
  const std::lock_guard lock(mutex_);
  total_ = stages;
}

void StageProgress::Add(int stages) {
  const std::lock_guard lock(mutex_);
  total_ += stages;
}

void StageProgress::Within(std::string work) {
  const std::lock_guard lock(mutex_);
  work_ = std::move(work);
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
  std::string stage = work_.empty() ? stage_ : absl::StrCat(work_, ": ", stage_);
  if (iteration_ > 0) absl::StrAppend(&stage, ": iteration ", iteration_);
  return {stage, std::clamp(begun_ - 1, 0, std::max(total_ - 1, 0)), total_};
}

}  // namespace mortise::simulator
