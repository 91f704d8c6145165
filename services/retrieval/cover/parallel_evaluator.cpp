// Threads that take one evaluation after the other.
#include "services/retrieval/cover/parallel_evaluator.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "absl/strings/str_cat.h"

namespace mortise::retrieval {
namespace {

constexpr std::size_t kMaxMessages = 10;

}  // namespace

void ParallelFor(int count, int threads, const std::function<void(int)>& work) {
  std::atomic<int> next = 0;
  const auto take = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < std::min(threads, count); ++i) others.emplace_back(take);
  take();
}

ParallelEvaluator::ParallelEvaluator(const Manifold& manifold, int threads)
    : manifold_(manifold), threads_(threads) {}

std::vector<absl::StatusOr<Eigen::VectorXd>> ParallelEvaluator::Evaluate(
    const std::vector<Eigen::VectorXd>& points) {
  std::vector<absl::StatusOr<Eigen::VectorXd>> values(points.size());
  ParallelFor(static_cast<int>(points.size()), threads_, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    values[at] = EvaluateOne(points[at]);
  });
  for (const auto& value : values) Count(value);
  return values;
}

absl::StatusOr<Eigen::VectorXd> ParallelEvaluator::EvaluateOne(const Eigen::VectorXd& q) const {
  absl::StatusOr<Eigen::VectorXd> value = manifold_.Evaluate(q);
  if (!value.ok()) return value;
  if (value->size() != manifold_.dimension()) {
    return absl::InternalError(
        absl::StrCat("a descriptor has ", value->size(), " numbers, not ", manifold_.dimension()));
  }
  if (!value->allFinite()) {
    return absl::InternalError("a descriptor has numbers that are no numbers");
  }
  return value;
}

void ParallelEvaluator::Count(const absl::StatusOr<Eigen::VectorXd>& value) {
  ++evaluations_;
  if (value.ok()) return;
  ++failures_;
  const std::string message(value.status().message());
  if (messages_.size() < kMaxMessages &&
      std::find(messages_.begin(), messages_.end(), message) == messages_.end()) {
    messages_.push_back(message);
  }
}

}  // namespace mortise::retrieval
