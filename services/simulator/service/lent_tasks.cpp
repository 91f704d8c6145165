#include "services/simulator/service/lent_tasks.h"

#include <cstddef>
#include <utility>

namespace mortise::simulator {
namespace {

template <typename Value>
void PutInto(SingleFlightCache<std::shared_ptr<const Value>>& cache, const std::string& key,
             const std::shared_ptr<const Value>& value, std::size_t bytes) {
  using Made = typename SingleFlightCache<std::shared_ptr<const Value>>::Made;
  cache.Get(key,
            [&]() -> absl::StatusOr<Made> {
              return Made{value, key.size() + bytes};
            })
      .IgnoreError();
}

}  // namespace

std::shared_ptr<const v1::Evaluator> LentTasks::FindEvaluator(const std::string& digest) {
  return evaluators_.Find(digest).value_or(nullptr);
}

std::shared_ptr<const v1::Evaluator> LentTasks::PutEvaluator(const std::string& digest,
                                                             v1::Evaluator evaluator) {
  const auto kept = std::make_shared<const v1::Evaluator>(std::move(evaluator));
  PutInto(evaluators_, digest, kept, kept->SpaceUsedLong());
  return kept;
}

std::shared_ptr<const LentTask> LentTasks::Find(const std::string& key) {
  return tasks_.Find(key).value_or(nullptr);
}

void LentTasks::Put(const std::string& key, LentTask lent) {
  const auto kept = std::make_shared<const LentTask>(std::move(lent));
  PutInto(tasks_, key, kept, sizeof(LentTask) + kept->task.SpaceUsedLong());
}

}  // namespace mortise::simulator
