// The fronts that were asked about last, in memory.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "services/pareto/service/front_queries.h"

namespace mortise::pareto {

// What can be asked about a front never changes once it is stored, so that what is here is as good
// as the store's. What does change, its external ids and labels, is not kept. May be used by many
// threads.
class FrontCache {
 public:
  // Keeps up to `capacity` fronts, at least 1.
  explicit FrontCache(std::size_t capacity) : capacity_(capacity) {}

  // Returns the front `name`, without external ids, labels and creator: the one kept, else what
  // `load` gives, which is kept if it is one. Several threads may load the same front at once.
  absl::StatusOr<std::shared_ptr<const OpenFront>> Find(
      const std::string& name, const std::function<absl::StatusOr<v1::Front>()>& load);

 private:
  using Kept = std::pair<std::string, std::shared_ptr<const OpenFront>>;

  std::shared_ptr<const OpenFront> Known(const std::string& name);

  const std::size_t capacity_;
  absl::Mutex mutex_;
  std::list<Kept> kept_ ABSL_GUARDED_BY(mutex_);  // last asked for first
};

}  // namespace mortise::pareto
