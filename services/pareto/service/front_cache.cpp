#include "services/pareto/service/front_cache.h"

#include <algorithm>

#include "common/base/errors.h"
#include "common/resources/resource_tags.h"

namespace mortise::pareto {

std::shared_ptr<const OpenFront> FrontCache::Known(const std::string& name) {
  const absl::MutexLock lock(&mutex_);
  const auto at = std::ranges::find(kept_, name, &Kept::first);
  if (at == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, at);
  return kept_.front().second;
}

absl::StatusOr<std::shared_ptr<const OpenFront>> FrontCache::Find(
    const std::string& name, const std::function<absl::StatusOr<v1::Front>()>& load) {
  if (auto known = Known(name)) return known;
  MORTISE_ASSIGN_OR_RETURN(v1::Front loaded, load());
  resources::ClearTags(&loaded);
  auto opened = std::make_shared<const OpenFront>(std::move(loaded));
  const absl::MutexLock lock(&mutex_);
  std::erase_if(kept_, [&](const Kept& kept) { return kept.first == name; });
  kept_.emplace_front(name, opened);
  if (kept_.size() > capacity_) kept_.pop_back();
  return opened;
}

}  // namespace mortise::pareto
