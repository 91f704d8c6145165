// Space-filling and perturbed samples.
#include "services/pareto/archive/stochastic_sampling.h"

#include <cmath>
#include <numeric>
#include <utility>

namespace mortise::pareto {

std::vector<Eigen::VectorXd> LatinHypercube(std::int64_t count, Eigen::Index size, Random& random) {
  std::vector<Eigen::VectorXd> points(static_cast<std::size_t>(count), Eigen::VectorXd(size));
  std::vector<std::size_t> order(points.size());
  for (Eigen::Index i = 0; i < size; ++i) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random.Index(k)]);
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k][i] =
          (static_cast<double>(order[k]) + random.Uniform()) / static_cast<double>(count);
    }
  }
  return points;
}

Eigen::VectorXd PerturbedSample(const Eigen::VectorXd& u, double delta_p, Random& random) {
  const double scale = std::exp2(-delta_p * random.Uniform());
  return (u + scale * random.UnitVector(u.size())).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace mortise::pareto
