// A covering, then parabolas.
#include "services/pareto/sources/line_minimum.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <ranges>
#include <utility>
#include <vector>

namespace mortise::pareto {
namespace {

constexpr std::size_t kManyValues = 20;  // of a function that ripples
constexpr int kFirstPoints = 8;          // that cover the range at first, at most
constexpr std::size_t kValleys = 16;     // that parabolas lead down from at first
constexpr int kRounds = 8;               // of parabolas, at most
constexpr double kMinGap = 1e-7;         // between points
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Point = std::pair<double, double>;

double ParabolaAt(double x, const Point& a, const Point& b, const Point& c) {
  const double ab = (b.second - a.second) / (b.first - a.first);
  const double bc = (c.second - b.second) / (c.first - b.first);
  const double curvature = (bc - ab) / (c.first - a.first);
  return a.second + (x - a.first) * (ab + curvature * (x - b.first));
}

}  // namespace

LineMinimum::LineMinimum(const Options& options, double known, double value, Random& random)
    : options_(options), random_(random.Next()), values_{{known, value}} {
  const int gaps = std::clamp(options.values, 3, kFirstPoints) - 1;
  queue_.push_back(0);
  for (int gap = 1; gap < gaps; ++gap) {
    queue_.push_back((gap + 0.6 * (random_.Uniform() - 0.5)) / gaps);
  }
  queue_.push_back(1);
}

std::optional<double> LineMinimum::Ask() {
  if (queue_.empty()) return std::nullopt;
  const double point = queue_.front();
  queue_.pop_front();
  ++outstanding_;
  return point;
}

void LineMinimum::Tell(double point, double value) {
  --outstanding_;
  values_[point] = std::isfinite(value) ? value : kInfinity;
  if (!queue_.empty() || outstanding_ > 0) return;
  NextStage();
  finished_ = queue_.empty();
}

double LineMinimum::Least() const { return std::ranges::min(values_ | std::views::values); }

double LineMinimum::Most() const {
  double most = -kInfinity;
  for (const double value : values_ | std::views::values) {
    if (value < kInfinity) most = std::max(most, value);
  }
  return most;
}

// Leaves the queue empty when nothing is left to try.
void LineMinimum::NextStage() {
  if (covering_) {
    // Where values are rounded, what lies between two of them may have been answered before.
    const bool has_grown = values_.size() > std::exchange(covered_, values_.size());
    if (has_grown && static_cast<int>(values_.size()) < options_.values && Ripples()) QueueHalves();
    if (!queue_.empty()) return;
    covering_ = false;
    rippled_ = values_.size() > kManyValues;
  }
  const double least = Least();
  const std::size_t valleys = std::max<std::size_t>(1, kValleys >> rounds_);
  const bool still = rounds_ > 0 && least_ - least <= options_.tolerance * (Most() - least);
  if (rounds_ >= kRounds || (valleys == 1 && still)) return;
  ++rounds_;
  least_ = least;
  QueueVertices(valleys);
}

// A point somewhere in the middle of each gap, so that no regular pattern goes unseen.
void LineMinimum::QueueHalves() {
  for (auto a = values_.begin(), b = std::next(a); b != values_.end(); a = b++) {
    const double gap = b->first - a->first;
    if (gap * options_.values > 1) {
      queue_.push_back(a->first + gap * (0.5 + 0.3 * (random_.Uniform() - 0.5)));
    }
  }
}

// Whether parabolas through neighbours miss what is between them by much.
bool LineMinimum::Ripples() const {
  std::vector<std::pair<double, double>> known;
  for (const auto& entry : values_) {
    if (entry.second < kInfinity) known.push_back(entry);
  }
  if (known.size() < 4) return false;
  const auto [least, most] = std::ranges::minmax(known | std::views::values);
  double missed = 0;
  for (std::size_t i = 1; i + 2 < known.size(); ++i) {
    missed += std::abs(known[i].second -
                       ParabolaAt(known[i].first, known[i - 1], known[i + 1], known[i + 2]));
  }
  return missed > options_.roughness * static_cast<double>(known.size() - 3) * (most - least);
}

void LineMinimum::QueueVertices(std::size_t valleys) {
  std::vector<std::pair<double, double>> lowest;  // value and point
  for (auto b = values_.begin(); b != values_.end(); ++b) {
    if (b->second == kInfinity) continue;
    if (b != values_.begin() && std::prev(b)->second < b->second) continue;
    if (std::next(b) != values_.end() && std::next(b)->second <= b->second) continue;
    lowest.emplace_back(b->second, b->first);
  }
  std::ranges::sort(lowest);
  for (std::size_t i = 0; i < std::min(valleys, lowest.size()); ++i) {
    const std::optional<double> vertex = VertexAt(lowest[i].second);
    if (vertex) queue_.push_back(*vertex);
  }
}

// Where the parabola through a point and its neighbours is least; at an end, a point beside it.
std::optional<double> LineMinimum::VertexAt(double point) const {
  const auto b = values_.find(point);
  const bool first = b == values_.begin(), last = std::next(b) == values_.end();
  if (first && last) return std::nullopt;
  double vertex = 0;
  if (first || last) {
    const double other = first ? std::next(b)->first : std::prev(b)->first;
    vertex = b->first + 0.1 * (other - b->first);
  } else {
    const auto a = std::prev(b), c = std::next(b);
    const double left = (b->second - a->second) / (b->first - a->first);
    const double right = (c->second - b->second) / (c->first - b->first);
    const double curvature = (right - left) / (c->first - a->first);
    const double nearest = 1e-3 * (c->first - a->first);
    vertex = 0.5 * (a->first + b->first - left / curvature);
    if (!std::isfinite(vertex) || std::abs(vertex - b->first) < nearest) {
      vertex = b->first + (c->first - b->first > b->first - a->first ? nearest : -nearest);
    }
    vertex = std::clamp(vertex, a->first + 0.05 * (b->first - a->first),
                        c->first - 0.05 * (c->first - b->first));
  }
  const auto above = values_.lower_bound(vertex);
  if (above != values_.end() && above->first - vertex < kMinGap) return std::nullopt;
  if (above != values_.begin() && vertex - std::prev(above)->first < kMinGap) return std::nullopt;
  return vertex;
}

}  // namespace mortise::pareto
