#include "services/pareto/discovery/combination_search.h"

#include <utility>

namespace mortise::pareto {

CombinationSearch::CombinationSearch(const DesignSpace& space, Eigen::Index metric_count,
                                     const Discovery::Options& options)
    : space_(space), metric_count_(metric_count), options_(options) {
  options_.uses_all_told = true;
}

void CombinationSearch::Try(const std::vector<Eigen::VectorXd>& designs) {
  queue_.insert(queue_.end(), designs.begin(), designs.end());
}

CombinationSearch::Design CombinationSearch::TryNow(const Eigen::VectorXd& x) {
  ++tried_under_way_;
  return {x};
}

std::optional<CombinationSearch::Design> CombinationSearch::AskQueued() {
  if (queue_.empty()) return std::nullopt;
  Design design{std::move(queue_.front())};
  queue_.pop_front();
  ++tried_under_way_;
  return design;
}

std::optional<CombinationSearch::Design> CombinationSearch::Ask() {
  if (std::optional<Design> queued = AskQueued()) return queued;
  if (!discovery_) {
    if (planned_ == 0 || tried_under_way_ > 0 || exhausted_) return std::nullopt;
    Begin();
  }
  if (std::optional<Discovery::Proposal> proposal = discovery_->Ask()) {
    return Design{std::move(proposal->x), proposal->number};
  }
  if (!discovery_->Finished()) return std::nullopt;
  if (discovery_->summary().stop_reason == Discovery::StopReason::kConverged) {
    exhausted_ = true;
    return std::nullopt;
  }
  pieces_ = Pieces();
  optimizations_ = Optimizations();
  expansions_ = Expansions();
  surrogates_ = Surrogates();
  discovery_.reset();
  return std::nullopt;
}

void CombinationSearch::Begin() {
  options_.evaluations = last_plan_ = std::exchange(planned_, 0);
  discovery_ = *Discovery::Create(space_, metric_count_, options_);
  ++options_.seed;
  // They were checked when they were told.
  for (const Evaluation& evaluation : known_) discovery_->Learn(evaluation).IgnoreError();
}

void CombinationSearch::Tell(std::int64_t number, Evaluation evaluation) {
  if (number < 0) --tried_under_way_;
  known_.push_back(evaluation);
  if (!discovery_) return;
  const absl::Status told =
      number < 0 ? discovery_->Learn(evaluation) : discovery_->Tell(number, std::move(evaluation));
  told.IgnoreError();
}

std::vector<AffinePiece> CombinationSearch::Pieces() const {
  std::vector<AffinePiece> pieces = pieces_;
  if (discovery_) {
    pieces.insert(pieces.end(), discovery_->pieces().begin(), discovery_->pieces().end());
  }
  return pieces;
}

std::int64_t CombinationSearch::Optimizations() const {
  return optimizations_ + (discovery_ ? discovery_->summary().optimizations : 0);
}

std::int64_t CombinationSearch::Expansions() const {
  return expansions_ + (discovery_ ? discovery_->summary().expansions : 0);
}

SurrogateTally CombinationSearch::Surrogates() const {
  SurrogateTally surrogates = surrogates_;
  if (discovery_) surrogates.Add(discovery_->surrogate_tally());
  return surrogates;
}

}  // namespace mortise::pareto
