// The cells of the performance buffer.
#include "services/pareto/archive/performance_buffer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise::pareto {
namespace {

constexpr int kMinCells = 3;  // per angle, of a buffer that can become coarser

}  // namespace

PerformanceBuffer::PerformanceBuffer(const Options& options, Eigen::Index metric_count)
    : options_(options), metric_count_(metric_count), cells_per_angle_(options.cells_per_angle) {}

PerformanceBuffer::CellId PerformanceBuffer::CellCount() const {
  CellId count = 1;
  for (Eigen::Index k = 0; k + 1 < metric_count_; ++k) count *= cells_per_angle_;
  return count;
}

PerformanceBuffer::CellId PerformanceBuffer::CellOf(const Eigen::VectorXd& scaled) const {
  const Eigen::VectorXd y = scaled.cwiseMax(0.0);
  CellId cell = 0;
  for (Eigen::Index k = 0; k + 1 < metric_count_; ++k) {
    const double angle = std::atan2(y.tail(metric_count_ - 1 - k).norm(), y[k]);
    const auto part =
        static_cast<CellId>(angle / (std::numbers::pi / 2) * static_cast<double>(cells_per_angle_));
    cell = cell * cells_per_angle_ + std::clamp<CellId>(part, 0, cells_per_angle_ - 1);
  }
  return cell;
}

Eigen::VectorXd PerformanceBuffer::DirectionOf(CellId cell) const {
  Eigen::VectorXd direction(metric_count_);
  std::vector<double> angles(static_cast<std::size_t>(metric_count_ - 1));
  for (auto angle = angles.rbegin(); angle != angles.rend(); ++angle) {
    *angle = (static_cast<double>(cell % cells_per_angle_) + 0.5) /
             static_cast<double>(cells_per_angle_) * std::numbers::pi / 2;
    cell /= cells_per_angle_;
  }
  double rest = 1;
  for (Eigen::Index k = 0; k + 1 < metric_count_; ++k) {
    direction[k] = rest * std::cos(angles[static_cast<std::size_t>(k)]);
    rest *= std::sin(angles[static_cast<std::size_t>(k)]);
  }
  direction[metric_count_ - 1] = rest;
  return direction;
}

bool PerformanceBuffer::Insert(std::size_t entry, const Eigen::VectorXd& scaled,
                               double* improvement) {
  const double distance = scaled.cwiseMax(0.0).norm();
  std::vector<Candidate>& list = cells_[CellOf(scaled)];
  if (improvement != nullptr) {
    *improvement = list.empty() ? 1.0 : std::max(0.0, list.front().distance - distance);
  }
  if (!list.empty() && distance > list.front().distance + options_.tolerance) return false;
  const auto place =
      std::upper_bound(list.begin(), list.end(), distance,
                       [](double r, const Candidate& other) { return r < other.distance; });
  const bool kept = place - list.begin() < options_.candidates_per_cell;
  list.insert(place, {entry, distance});
  const double limit = list.front().distance + options_.tolerance;
  while (list.back().distance > limit ||
         static_cast<int>(list.size()) > options_.candidates_per_cell) {
    list.pop_back();
  }
  return kept;
}

bool PerformanceBuffer::NeedsRebuild(const Scaling& current) const {
  if (scaling_.ideal.size() == 0) return true;
  if (MayCoarsen() && cells_.size() > 2 * options_.cell_limit) return true;
  const Eigen::VectorXd ideal_shift = (current.ideal - scaling_.ideal).cwiseAbs();
  const Eigen::VectorXd nadir_shift =
      (current.ideal + current.range - scaling_.ideal - scaling_.range).cwiseAbs();
  return (ideal_shift.array() > options_.rebuild_movement * scaling_.range.array()).any() ||
         (nadir_shift.array() > options_.rebuild_movement * scaling_.range.array()).any();
}

void PerformanceBuffer::Rebuild(const Archive& archive, const Scaling& scaling) {
  scaling_ = scaling;
  cells_per_angle_ = options_.cells_per_angle;
  Refill(archive);
  while (MayCoarsen() && cells_.size() > options_.cell_limit) {
    cells_per_angle_ = cells_per_angle_ * 3 / 4;
    Refill(archive);
  }
}

bool PerformanceBuffer::MayCoarsen() const {
  return options_.cell_limit > 0 && cells_per_angle_ >= kMinCells;
}

void PerformanceBuffer::Refill(const Archive& archive) {
  cells_.clear();
  for (std::size_t i = 0; i < archive.size(); ++i) {
    if (archive[i].feasible) Insert(i, scaling_.Apply(archive[i].metrics));
  }
}

}  // namespace mortise::pareto
