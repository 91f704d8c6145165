// Lines side by side, put together, over and over.
#include "services/pareto/sources/coordinate_descent.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace mortise::pareto {
namespace {

constexpr int kPasses = 2;  // where lines do not ripple, if they have at least
constexpr int kFine = 8;    // so many values

}  // namespace

CoordinateDescent::CoordinateDescent(const Options& options, const Archive& archive,
                                     std::size_t start, Random& random)
    : options_(options), random_(random.Next()), best_(start), best_of_last_pass_(start) {
  order_.resize(static_cast<std::size_t>(archive[start].u.size()));
  std::iota(order_.begin(), order_.end(), Eigen::Index{0});
  BeginPass(archive);
}

// Half the square of the distance to where every metric is better than the best seen by the range
// of the front; beyond the best seen, as better ones are found, it goes on falling in a straight
// line.
double CoordinateDescent::BadnessOf(const Archive& archive, std::size_t entry) const {
  if (!archive[entry].feasible) return std::numeric_limits<double>::infinity();
  double badness = 0;
  for (const double y : scaling_.Apply(archive[entry].metrics)) {
    badness += y > 0 ? 0.5 * (y + 1) * (y + 1) : 0.5 + y;
  }
  return badness;
}

void CoordinateDescent::BeginPass(const Archive& archive) {
  for (std::size_t i = order_.size(); i > 1; --i) {
    std::swap(order_[i - 1], order_[random_.Index(i)]);
  }
  next_ = 0;
  rippled_ = 0;
  best_of_last_pass_ = best_;
  BeginLines(archive);
}

void CoordinateDescent::BeginLines(const Archive& archive) {
  scaling_ = archive.CurrentScaling();
  const double badness = BadnessOf(archive, best_);
  lines_.clear();
  for (int i = 0; i < options_.lines && next_ < order_.size(); ++i) {
    const Eigen::Index parameter = order_[next_++];
    lines_.push_back({parameter,
                      LineMinimum(options_.line, archive[best_].u[parameter], badness, random_),
                      best_});
  }
}

std::optional<Eigen::VectorXd> CoordinateDescent::Ask(Archive& archive) {
  if (finished_) return std::nullopt;
  if (together_) {
    asked_.push_back(lines_.size());
    ++evaluations_;
    return *std::exchange(together_, std::nullopt);
  }
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::optional<double> point = lines_[i].minimum.Ask();
    if (!point) continue;
    Eigen::VectorXd u = archive[best_].u;
    u[lines_[i].parameter] = *point;
    asked_.push_back(i);
    ++evaluations_;
    return u;
  }
  return std::nullopt;
}

void CoordinateDescent::Tell(Archive& archive, std::size_t entry) {
  const std::size_t asked = asked_.front();
  asked_.pop_front();
  const double badness = BadnessOf(archive, entry);
  if (asked == lines_.size()) {
    if (badness < BadnessOf(archive, best_)) best_ = entry;
    EndLines(archive);
    return;
  }
  Line& line = lines_[asked];
  line.minimum.Tell(archive[entry].u[line.parameter], badness);
  if (badness < BadnessOf(archive, line.best)) line.best = entry;
  if (!std::ranges::all_of(lines_, [](const Line& each) { return each.minimum.Finished(); })) {
    return;
  }
  Eigen::VectorXd u = archive[best_].u;
  for (const Line& each : lines_) u[each.parameter] = archive[each.best].u[each.parameter];
  together_ = std::move(u);
  best_ = std::ranges::min(lines_, {}, [&](const Line& each) {
            return BadnessOf(archive, each.best);
          }).best;
}

void CoordinateDescent::EndLines(const Archive& archive) {
  rippled_ +=
      std::ranges::count_if(lines_, [](const Line& each) { return each.minimum.rippled(); });
  if (evaluations_ >= options_.evaluations) {
    finished_ = true;
  } else if (next_ < order_.size()) {
    BeginLines(archive);
  } else {
    scaling_ = archive.CurrentScaling();
    const bool still =
        BadnessOf(archive, best_) > BadnessOf(archive, best_of_last_pass_) - options_.progress;
    const bool ripples = 2 * rippled_ >= static_cast<std::ptrdiff_t>(order_.size());
    const int passes = options_.line.values < kFine ? 1 : kPasses;
    finished_ = still || (++passes_ >= passes && !ripples);
    if (!finished_) BeginPass(archive);
  }
}

}  // namespace mortise::pareto
