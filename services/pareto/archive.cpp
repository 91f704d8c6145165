// The archive of committed evaluations.
#include "services/pareto/archive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/pareto/non_dominated.h"

namespace mortise::pareto {

std::size_t Archive::Add(ArchiveEntry entry) {
  const std::size_t index = entries_.size();
  entries_.push_back(std::move(entry));
  const ArchiveEntry& added = entries_.back();
  if (!added.feasible) return index;
  ++feasible_count_;
  if (feasible_count_ == 1) ideal_ = worst_ = added.metrics;
  ideal_ = ideal_.cwiseMin(added.metrics).eval();
  worst_ = worst_.cwiseMax(added.metrics).eval();
  const bool covered =
      std::any_of(non_dominated_.begin(), non_dominated_.end(), [&](std::size_t other) {
        return entries_[other].metrics == added.metrics ||
               Dominates(entries_[other].metrics, added.metrics);
      });
  if (covered) return index;
  std::erase_if(non_dominated_, [&](std::size_t other) {
    return Dominates(added.metrics, entries_[other].metrics);
  });
  non_dominated_.push_back(index);
  return index;
}

Scaling Archive::CurrentScaling() const {
  Eigen::VectorXd nadir = ideal_;
  for (const std::size_t index : non_dominated_) nadir = nadir.cwiseMax(entries_[index].metrics);
  Scaling scaling{ideal_, nadir - ideal_};
  for (Eigen::Index i = 0; i < scaling.range.size(); ++i) {
    // A front that is still one point (or one by nature) has no range of its own.
    const double seen = worst_[i] - ideal_[i];
    if (scaling.range[i] > 1e-3 * seen && scaling.range[i] > 1e-12 * std::abs(ideal_[i])) continue;
    scaling.range[i] = 0.1 * seen;
    if (!(seen > 1e-12 * std::abs(ideal_[i]))) scaling.range[i] = 1;
  }
  return scaling;
}

std::vector<std::size_t> Archive::Nearest(const Eigen::VectorXd& u, std::size_t count) const {
  std::vector<std::pair<double, std::size_t>> distances;
  distances.reserve(entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].feasible) distances.emplace_back((entries_[i].u - u).squaredNorm(), i);
  count = std::min(count, distances.size());
  std::partial_sort(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(count),
                    distances.end());
  std::vector<std::size_t> nearest(count);
  for (std::size_t i = 0; i < count; ++i) nearest[i] = distances[i].second;
  return nearest;
}

void Archive::Remember(std::size_t entry, Eigen::MatrixXd jacobian) {
  if (entries_[entry].jacobian_estimate.size() == 0) remembered_.push_back(entry);
  entries_[entry].jacobian_estimate = std::move(jacobian);
}

Eigen::MatrixXd Archive::PriorJacobian(const Eigen::VectorXd& u) const {
  const auto nearest =
      std::min_element(remembered_.begin(), remembered_.end(), [&](std::size_t a, std::size_t b) {
        return (entries_[a].u - u).squaredNorm() < (entries_[b].u - u).squaredNorm();
      });
  return nearest == remembered_.end() ? Eigen::MatrixXd() : entries_[*nearest].jacobian_estimate;
}

bool Archive::ClearlyDominated(const Eigen::VectorXd& metrics, const Scaling& scaling,
                               double margin) const {
  return std::any_of(non_dominated_.begin(), non_dominated_.end(), [&](std::size_t other) {
    const Eigen::VectorXd worse = (metrics - entries_[other].metrics).cwiseQuotient(scaling.range);
    return worse.minCoeff() >= margin || (worse.minCoeff() >= 0 && worse.maxCoeff() > 3 * margin);
  });
}

}  // namespace mortise::pareto
