#include "services/pareto/models/combination_model.h"

#include <Eigen/Cholesky>

namespace mortise::pareto {
namespace {

constexpr double kRidge = 0.3;  // evaluations' worth of belief in no effect

}  // namespace

CombinationModel::CombinationModel(const std::vector<DiscreteParameter>& discrete,
                                   const std::vector<Sample>& samples) {
  Eigen::Index rows = 0;
  for (const DiscreteParameter& each : discrete) {
    first_.push_back(rows);
    rows += static_cast<Eigen::Index>(each.values.size());
  }
  const Eigen::Index others = samples.front().u.size(), size = rows + 2 * others + 1;
  const Eigen::Index d = samples.front().metrics.size();
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, d);
  Eigen::VectorXd features(size);
  for (const Sample& sample : samples) {
    features.setZero();
    for (std::size_t k = 0; k < discrete.size(); ++k) {
      features[first_[k] + (*sample.combination)[k]] = 1;
    }
    features.segment(rows, others) = sample.u;
    features.segment(rows + others, others) = sample.u.cwiseAbs2();
    features[size - 1] = 1;
    products.selfadjointView<Eigen::Lower>().rankUpdate(features);
    right += features * sample.metrics.transpose();
  }
  products.diagonal().head(size - 1).array() += kRidge;
  products(size - 1, size - 1) += 1e-6;
  const Eigen::MatrixXd full = products.selfadjointView<Eigen::Lower>();
  effects_ = Eigen::MatrixXd(full.ldlt().solve(right)).topRows(rows);
}

Eigen::VectorXd CombinationModel::Difference(const Combination& from, const Combination& to) const {
  Eigen::VectorXd difference = Eigen::VectorXd::Zero(effects_.cols());
  for (std::size_t k = 0; k < first_.size(); ++k) {
    difference += (effects_.row(first_[k] + to[k]) - effects_.row(first_[k] + from[k])).transpose();
  }
  return difference;
}

}  // namespace mortise::pareto
