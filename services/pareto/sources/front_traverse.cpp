// A covering, then gaps.
#include "services/pareto/sources/front_traverse.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

namespace mortise::pareto {
namespace {

constexpr int kFirstValues = 8;
constexpr int kGaps = 4;          // of a round
constexpr double kMinGap = 1e-4;  // of the parameter

}  // namespace

FrontTraverse::FrontTraverse(const Options& options, const Archive& archive, const Scaling& scaling,
                             std::size_t entry, Eigen::Index parameter)
    : options_(options), scaling_(scaling), start_(archive[entry].u), parameter_(parameter) {
  line_.emplace(start_[parameter], entry);
  for (int k = 0; k < kFirstValues; ++k) {
    queue_.push_back(static_cast<double>(k) / (kFirstValues - 1));
  }
}

std::optional<Eigen::VectorXd> FrontTraverse::Ask(Archive&) {
  if (queue_.empty()) return std::nullopt;
  Eigen::VectorXd u = start_;
  u[parameter_] = queue_.front();
  tried_.insert(queue_.front());
  queue_.pop_front();
  ++outstanding_;
  ++evaluations_;
  return u;
}

void FrontTraverse::Tell(Archive& archive, std::size_t entry) {
  --outstanding_;
  if (archive[entry].feasible) line_.emplace(archive[entry].u[parameter_], entry);
  if (Finished()) QueueGaps(archive);
}

void FrontTraverse::QueueGaps(const Archive& archive) {
  const auto is_dominated = [&](std::size_t entry) {
    return archive.ClearlyDominated(archive[entry].metrics, scaling_, options_.tolerance);
  };
  std::vector<std::pair<double, double>> gaps;  // how wide, and the middle
  for (auto a = line_.begin(), b = std::next(a); b != line_.end(); a = b++) {
    const double middle = 0.5 * (a->first + b->first);
    // A middle that failed, or that a workshop cannot set, brings nothing the second time either.
    if (b->first - a->first < kMinGap || tried_.contains(middle) ||
        (is_dominated(a->second) && is_dominated(b->second))) {
      continue;
    }
    const double width =
        (scaling_.Apply(archive[a->second].metrics) - scaling_.Apply(archive[b->second].metrics))
            .norm();
    if (width > options_.spacing) gaps.emplace_back(width, middle);
  }
  std::ranges::sort(gaps, std::greater());
  const int most = std::min(kGaps, options_.evaluations - evaluations_);
  for (int k = 0; k < std::min(most, static_cast<int>(gaps.size())); ++k) {
    queue_.push_back(gaps[static_cast<std::size_t>(k)].second);
  }
}

}  // namespace mortise::pareto
