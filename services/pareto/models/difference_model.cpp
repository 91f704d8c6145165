#include "services/pareto/models/difference_model.h"

#include <utility>

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

}  // namespace

DifferenceModel::DifferenceModel(const QuadraticModel& model, std::vector<Index> coordinates,
                                 double step)
    : model_(model), coordinates_(std::move(coordinates)) {
  const VectorXd& u = model_.centre;
  for (const Index i : coordinates_) {
    const bool up = u[i] + step <= 1, down = u[i] - step >= 0;
    first_.push_back(up ? step : -step);
    second_.push_back(up && down ? -step : 2 * first_.back());
  }
  const std::size_t n = coordinates_.size();
  for (const std::vector<double>& steps : {first_, second_}) {
    for (std::size_t a = 0; a < n; ++a) {
      points_.push_back(u);
      points_.back()[coordinates_[a]] += steps[a];
    }
  }
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      points_.push_back(u);
      points_.back()[coordinates_[a]] += first_[a];
      points_.back()[coordinates_[b]] += first_[b];
    }
  }
}

std::optional<VectorXd> DifferenceModel::Ask() {
  if (asked_ == points_.size()) return std::nullopt;
  return points_[asked_++];
}

void DifferenceModel::Tell(const std::optional<VectorXd>& metrics) { told_.push_back(metrics); }

QuadraticModel DifferenceModel::Measured() const {
  QuadraticModel measured = model_;
  const std::size_t n = coordinates_.size();
  const Index d = model_.value.size();
  for (std::size_t a = 0; a < n; ++a) {
    const auto &one = told_[a], &two = told_[n + a];
    if (!one || !two) continue;
    const Index i = coordinates_[a];
    const VectorXd first = (*one - model_.value) / first_[a];
    const VectorXd second = (*two - model_.value) / second_[a];
    const VectorXd curvature = 2 * (first - second) / (first_[a] - second_[a]);
    measured.jacobian.col(i) = first - 0.5 * first_[a] * curvature;
    for (Index k = 0; k < d; ++k) {
      measured.hessians[static_cast<std::size_t>(k)](i, i) = curvature[k];
    }
  }
  std::size_t pair = 2 * n;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b, ++pair) {
      if (!told_[pair] || !told_[a] || !told_[b]) continue;
      const VectorXd mixed =
          (*told_[pair] - *told_[a] - *told_[b] + model_.value) / (first_[a] * first_[b]);
      for (Index k = 0; k < d; ++k) {
        Eigen::MatrixXd& H = measured.hessians[static_cast<std::size_t>(k)];
        H(coordinates_[a], coordinates_[b]) = H(coordinates_[b], coordinates_[a]) = mixed[k];
      }
    }
  }
  return measured;
}

}  // namespace mortise::pareto
