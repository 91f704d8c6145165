#include "services/pareto/sources/outlier_repair.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "services/pareto/archive/nearest_designs.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr double kMinDeviation = 0.0005;  // unit coordinates
constexpr double kOutlying = 4;           // interquartile ranges

struct Repair {
  double deviation = 0;  // the largest of its parameters, unit coordinates
  VectorXd u;
};

// Of an even number of values.
double Median(const std::vector<double>& sorted) {
  const std::size_t half = sorted.size() / 2;
  return 0.5 * (sorted[half - 1] + sorted[half]);
}

// With the parameters that are out of line set to the median of `neighbours`.
Repair RepairOf(const VectorXd& u, const std::vector<VectorXd>& neighbours) {
  Repair repair{0, u};
  std::vector<double> values(neighbours.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    std::ranges::transform(neighbours, values.begin(), [i](const VectorXd& v) { return v[i]; });
    std::ranges::sort(values);
    const std::size_t quarter = values.size() / 4;
    const double range = values[values.size() - 1 - quarter] - values[quarter];
    const double median = Median(values), deviation = std::abs(u[i] - median);
    if (deviation <= std::max(kMinDeviation, kOutlying * range)) continue;
    repair.u[i] = median;
    repair.deviation = std::max(repair.deviation, deviation);
  }
  return repair;
}

}  // namespace

std::vector<VectorXd> RepairedOutliers(const Archive& archive, const Scaling& scaling,
                                       std::size_t count) {
  const std::vector<std::size_t>& entries = archive.non_dominated();
  const auto neighbours = static_cast<std::size_t>(6 + 4 * (scaling.ideal.size() - 2));
  if (count == 0 || scaling.ideal.size() < 2 || entries.size() <= neighbours) return {};
  const Eigen::MatrixXd front = ScaledFront(archive, scaling);
  const NearestDesigns::Designs points(front.data(), front.rows(), front.cols());
  NearestDesigns nearest;
  for (std::size_t point = 0; point < entries.size(); ++point) nearest.Add(point, points);
  const VectorXd all = VectorXd::Ones(front.rows());
  std::vector<Repair> repairs;
  for (std::size_t point = 0; point < entries.size(); ++point) {
    std::vector<VectorXd> designs;
    const VectorXd y = front.col(static_cast<Eigen::Index>(point));
    for (const std::size_t near : nearest.Nearest(y, all, neighbours + 1, points)) {
      if (near != point) designs.push_back(archive[entries[near]].u);
    }
    Repair repair = RepairOf(archive[entries[point]].u, designs);
    if (repair.deviation > 0) repairs.push_back(std::move(repair));
  }
  std::ranges::stable_sort(repairs, std::greater<>{}, &Repair::deviation);
  std::vector<VectorXd> designs;
  for (Repair& repair : repairs) {
    if (designs.size() == count) break;
    designs.push_back(std::move(repair.u));
  }
  return designs;
}

}  // namespace mortise::pareto
