// The archive of committed evaluations.
#include "services/pareto/archive/archive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mortise::pareto {

using Eigen::VectorXd;

std::size_t Archive::Add(ArchiveEntry entry) {
  const std::size_t index = entries_.size();
  displaced_.clear();
  designs_.insert(designs_.end(), entry.u.begin(), entry.u.end());
  if (lengths_.size() == 0) lengths_ = VectorXd::Ones(entry.u.size());
  entries_.push_back(std::move(entry));
  ArchiveEntry& added = entries_.back();
  added.feasible = added.evaluated && (added.constraints.array() <= 0).all();
  if (!added.evaluated) return index;
  evaluated_.Add(index, Designs());
  if (++evaluated_count_ == 1) constraint_sizes_ = VectorXd::Zero(added.constraints.size());
  constraint_sizes_ = constraint_sizes_.cwiseMax(added.constraints.cwiseAbs()).eval();
  if (!added.feasible && feasible_count_ > 0) return index;
  if (added.feasible) ++feasible_count_;
  if (evaluated_count_ == 1 || feasible_count_ == 1) ideal_ = worst_ = added.metrics;
  ideal_ = ideal_.cwiseMin(added.metrics).eval();
  worst_ = worst_.cwiseMax(added.metrics).eval();
  if (added.feasible) AddToFront(index);
  return index;
}

void Archive::AddToFront(std::size_t entry) {
  const VectorXd& metrics = entries_[entry].metrics;
  const auto d = static_cast<std::size_t>(metrics.size());
  const auto is_no_better = [d](const double* a, const double* b) {
    for (std::size_t i = 0; i < d; ++i) {
      if (a[i] < b[i]) return false;
    }
    return true;
  };
  // Equal to one of them, or dominated by it.
  for (std::size_t k = 0; k < non_dominated_.size(); ++k) {
    if (is_no_better(metrics.data(), &front_[k * d])) return;
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < non_dominated_.size(); ++k) {
    if (is_no_better(&front_[k * d], metrics.data())) {
      displaced_.push_back(non_dominated_[k]);
      continue;
    }
    if (kept != k) {
      non_dominated_[kept] = non_dominated_[k];
      std::copy_n(&front_[k * d], d, &front_[kept * d]);
    }
    ++kept;
  }
  non_dominated_.resize(kept);
  front_.resize(kept * d);
  non_dominated_.push_back(entry);
  front_.insert(front_.end(), metrics.begin(), metrics.end());
}

Scaling Archive::CurrentScaling() const {
  const VectorXd nadir =
      non_dominated_.empty() ? ideal_ : VectorXd(non_dominated_metrics().rowwise().maxCoeff());
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

VectorXd Archive::ConstraintSizes() const {
  return (constraint_sizes_.array() > 0).select(constraint_sizes_, 1.0);
}

double Archive::Violation(std::size_t entry) const {
  const VectorXd& constraints = entries_[entry].constraints;
  double sum = 0;
  for (Eigen::Index j = 0; j < constraints.size(); ++j) {
    if (constraints[j] > 0) sum += std::pow(constraints[j] / constraint_sizes_[j], 2);
  }
  return std::sqrt(sum);
}

NearestDesigns::Designs Archive::Designs() const {
  return {designs_.data(), lengths_.size(), std::ssize(entries_)};
}

std::vector<std::size_t> Archive::Nearest(const VectorXd& u, std::size_t count) const {
  return evaluated_.Nearest(u, lengths_.cwiseInverse(), count, Designs());
}

void Archive::Keep(std::size_t entry, Estimate estimate, Eigen::MatrixXd jacobian,
                   NearestDesigns& kept) {
  if ((entries_[entry].*estimate).size() == 0) kept.Add(entry, Designs());
  entries_[entry].*estimate = std::move(jacobian);
}

Eigen::MatrixXd Archive::NearestOf(const NearestDesigns& kept, Estimate estimate,
                                   const VectorXd& u) const {
  const std::vector<std::size_t> nearest = kept.Nearest(u, VectorXd::Ones(u.size()), 1, Designs());
  return nearest.empty() ? Eigen::MatrixXd() : entries_[nearest.front()].*estimate;
}

void Archive::Remember(std::size_t entry, Eigen::MatrixXd jacobian) {
  Keep(entry, &ArchiveEntry::jacobian_estimate, std::move(jacobian), remembered_);
}

void Archive::RememberConstraints(std::size_t entry, Eigen::MatrixXd jacobian) {
  Keep(entry, &ArchiveEntry::constraint_jacobian_estimate, std::move(jacobian),
       remembered_constraints_);
}

Eigen::MatrixXd Archive::PriorJacobian(const VectorXd& u) const {
  return NearestOf(remembered_, &ArchiveEntry::jacobian_estimate, u);
}

Eigen::MatrixXd Archive::PriorConstraintJacobian(const VectorXd& u) const {
  return NearestOf(remembered_constraints_, &ArchiveEntry::constraint_jacobian_estimate, u);
}

Eigen::MatrixXd ScaledFront(const Archive& archive, const Scaling& scaling) {
  Eigen::MatrixXd front = archive.non_dominated_metrics().colwise() - scaling.ideal;
  front.array().colwise() /= scaling.range.array();
  return front;
}

bool Archive::ClearlyDominated(const VectorXd& metrics, const Scaling& scaling,
                               double margin) const {
  const auto d = static_cast<std::size_t>(metrics.size());
  for (std::size_t k = 0; k < non_dominated_.size(); ++k) {
    const double* const other = &front_[k * d];
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < d && least >= 0; ++i) {
      const auto metric = static_cast<Eigen::Index>(i);
      const double worse = (metrics[metric] - other[i]) / scaling.range[metric];
      least = std::min(least, worse);
      most = std::max(most, worse);
    }
    if (least >= margin || (least >= 0 && most > 3 * margin)) return true;
  }
  return false;
}

bool OffersEvery(const Eigen::MatrixXd& jacobian) {
  return jacobian.size() > 0 && !jacobian.array().isNaN().rowwise().all().any();
}

}  // namespace mortise::pareto
