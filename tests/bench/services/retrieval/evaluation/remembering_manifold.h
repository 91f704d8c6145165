// A manifold that remembers what it was asked: covers of several δ begin with the same samples.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "services/retrieval/cover/manifold.h"

namespace mortise::retrieval {

// As the manifold behind it in everything. Thread safe. Keeps up to `most_bytes` of values.
class RememberingManifold : public Manifold {
 public:
  explicit RememberingManifold(std::unique_ptr<Manifold> manifold,
                               std::size_t most_bytes = std::size_t{256} << 20)
      : manifold_(std::move(manifold)), most_bytes_(most_bytes) {}

  Eigen::Index parameters() const override { return manifold_->parameters(); }
  Eigen::Index dimension() const override { return manifold_->dimension(); }
  const LinearConstraints& constraints() const override { return manifold_->constraints(); }
  absl::StatusOr<std::vector<Eigen::VectorXd>> Sample(int count,
                                                      std::uint64_t seed) const override {
    return manifold_->Sample(count, seed);
  }
  absl::StatusOr<Eigen::VectorXd> Evaluate(const Eigen::VectorXd& q) const override;
  int Structure(const Eigen::VectorXd& q) const override { return manifold_->Structure(q); }
  double noise() const override { return manifold_->noise(); }
  bool OffersDerivatives() const override { return manifold_->OffersDerivatives(); }
  absl::StatusOr<Derivatives> DerivativesAt(const Eigen::VectorXd& q) const override {
    return manifold_->DerivativesAt(q);
  }

 private:
  std::unique_ptr<Manifold> manifold_;
  std::size_t most_bytes_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, absl::StatusOr<Eigen::VectorXd>> known_;  // by the bytes of q
  mutable std::size_t bytes_ = 0;
};

}  // namespace mortise::retrieval
