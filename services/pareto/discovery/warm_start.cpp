// Choice of designs spread along fronts.
#include "services/pareto/discovery/warm_start.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::int64_t kTwoMetrics = 24;  // designs, at most
constexpr std::int64_t kEachFurther = 4;  // times as many for each metric beyond two
constexpr std::int64_t kShare = 8;        // one part of so many of the budget

MatrixXd Scaled(const MatrixXd& metrics) {
  const VectorXd least = metrics.rowwise().minCoeff();
  VectorXd range = metrics.rowwise().maxCoeff() - least;
  for (double& value : range) {
    if (!(value > 0)) value = 1;
  }
  return range.cwiseInverse().asDiagonal() * (metrics.colwise() - least);
}

// The columns of `metrics`, up to `most`, so that the first few are spread already.
std::vector<Eigen::Index> SpreadOrder(const MatrixXd& metrics, Eigen::Index most) {
  if (metrics.cols() == 0) return {};
  const MatrixXd scaled = Scaled(metrics);
  VectorXd distance = VectorXd::Constant(scaled.cols(), std::numeric_limits<double>::infinity());
  std::vector<Eigen::Index> order;
  const auto take = [&](Eigen::Index chosen) {
    order.push_back(chosen);
    distance = distance.cwiseMin(
        (scaled.colwise() - scaled.col(chosen)).colwise().squaredNorm().transpose());
    distance[chosen] = -1;  // never again
  };
  const VectorXd sums = scaled.colwise().sum();
  for (Eigen::Index metric = 0; metric < scaled.rows(); ++metric) {
    // Several may be the best in it; one that no other of them dominates is taken.
    Eigen::Index best = 0;
    for (Eigen::Index i = 1; i < scaled.cols(); ++i) {
      if (std::pair(scaled(metric, i), sums[i]) < std::pair(scaled(metric, best), sums[best])) {
        best = i;
      }
    }
    if (distance[best] >= 0) take(best);
  }
  while (static_cast<Eigen::Index>(order.size()) < std::min(most, scaled.cols())) {
    Eigen::Index furthest = 0;
    distance.maxCoeff(&furthest);
    take(furthest);
  }
  return order;
}

}  // namespace

std::int64_t MostStartDesigns(std::int64_t evaluations, Eigen::Index metric_count) {
  std::int64_t most = kTwoMetrics;
  for (Eigen::Index d = 3; d <= metric_count; ++d) most *= kEachFurther;
  return std::min(most, evaluations / kShare);
}

MatrixXd StartDesigns(const DesignSpace& space, const std::vector<EarlierFront>& fronts,
                      std::int64_t most) {
  std::vector<std::vector<Eigen::Index>> orders;
  std::size_t longest = 0;
  for (const EarlierFront& front : fronts) {
    orders.push_back(SpreadOrder(front.metrics, front.metrics.cols()));
    longest = std::max(longest, orders.back().size());
  }
  std::set<std::vector<double>> taken;
  std::vector<VectorXd> designs;
  for (std::size_t rank = 0; rank < longest; ++rank) {
    for (std::size_t k = 0; k < fronts.size(); ++k) {
      if (rank >= orders[k].size() || static_cast<std::int64_t>(designs.size()) >= most) continue;
      const VectorXd x = space.Nearest(fronts[k].designs.col(orders[k][rank]));
      if (taken.insert({x.begin(), x.end()}).second) designs.push_back(x);
    }
  }
  MatrixXd columns(space.size(), static_cast<Eigen::Index>(designs.size()));
  for (std::size_t i = 0; i < designs.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) = designs[i];
  }
  return columns;
}

}  // namespace mortise::pareto
