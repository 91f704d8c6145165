#include "tests/bench/services/retrieval/evaluation/remembering_manifold.h"

namespace mortise::retrieval {

absl::StatusOr<Eigen::VectorXd> RememberingManifold::Evaluate(const Eigen::VectorXd& q) const {
  const std::string key(reinterpret_cast<const char*>(q.data()),
                        sizeof(double) * static_cast<std::size_t>(q.size()));
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
  }
  absl::StatusOr<Eigen::VectorXd> value = manifold_->Evaluate(q);
  const std::lock_guard lock(mutex_);
  const std::size_t bytes =
      sizeof(double) * static_cast<std::size_t>(value.ok() ? value->size() : 32);
  if (bytes_ + bytes <= most_bytes_ && known_.emplace(key, value).second) bytes_ += bytes;
  return value;
}

}  // namespace mortise::retrieval
