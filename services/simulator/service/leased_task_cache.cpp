#include "services/simulator/service/leased_task_cache.h"

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

std::shared_ptr<const v1::Evaluator> LeasedTaskCache::FindEvaluator(const std::string& digest) {
  return evaluators_.Find(digest).value_or(nullptr);
}

std::shared_ptr<const v1::Evaluator> LeasedTaskCache::PutEvaluator(const std::string& digest,
                                                                   v1::Evaluator evaluator) {
  const auto kept = std::make_shared<const v1::Evaluator>(std::move(evaluator));
  PutInto(evaluators_, digest, kept, kept->SpaceUsedLong());
  return kept;
}

std::shared_ptr<const LeasedTask> LeasedTaskCache::Find(const std::string& key) {
  return tasks_.Find(key).value_or(nullptr);
}

void LeasedTaskCache::Put(const std::string& key, LeasedTask leased) {
  const auto kept = std::make_shared<const LeasedTask>(std::move(leased));
  PutInto(tasks_, key, kept, sizeof(LeasedTask) + kept->task.SpaceUsedLong());
}

}  // namespace mortise::simulator
