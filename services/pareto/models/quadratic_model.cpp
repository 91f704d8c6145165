// Fitting of local quadratic models.
#include "services/pareto/models/quadratic_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace mortise::pareto {
namespace {

using Eigen::Index;

constexpr double kCurvatureWeight = 0.1;  // b for a = 1: curvature is believed in less than slope
constexpr double kMeanCurvatureWeight = 0.1;  // c: of what all directions share
constexpr double kInterpolation = 1e-9;       // slack of near neighbours: all but interpolated
constexpr double kCubicSlack = 0.03;          // growth of the slack: what third derivatives may do
constexpr double kThinning = 0.3;             // least distance between neighbours over that to c

// What is modelled: metrics or constraints.
struct Quantities {
  Eigen::VectorXd ArchiveEntry::*values;
  Eigen::MatrixXd ArchiveEntry::*jacobian;
};

constexpr Quantities kMetrics{&ArchiveEntry::metrics, &ArchiveEntry::jacobian};
constexpr Quantities kConstraints{&ArchiveEntry::constraints, &ArchiveEntry::constraint_jacobian};

bool OffersGradient(const Eigen::MatrixXd& jacobian, Index row) {
  return jacobian.rows() > row && !jacobian.row(row).array().isNaN().all();
}

// Adds to the model of each metric in `metrics` the kernel expansion with slope weight `a`. `radii`
// (D) are the lengths by which t was divided.
void FitKernels(const Eigen::MatrixXd& t, const Eigen::MatrixXd& residuals,
                const Eigen::VectorXd& slack, double a, const Eigen::VectorXd& radii,
                const std::vector<Index>& metrics, QuadraticModel& model) {
  if (metrics.empty() || t.cols() == 0) return;
  const Eigen::MatrixXd dots = t.transpose() * t;
  const Eigen::VectorXd squares = dots.diagonal();
  Eigen::MatrixXd kernel = a * dots + kCurvatureWeight * dots.cwiseAbs2() +
                           kMeanCurvatureWeight * squares * squares.transpose();
  kernel.diagonal() += slack;
  const Eigen::LDLT<Eigen::MatrixXd> factors(kernel);
  const Eigen::VectorXd per_radius = radii.cwiseInverse();
  for (const Index i : metrics) {
    const Eigen::VectorXd weights = factors.solve(residuals.row(i).transpose());
    if (!weights.allFinite()) continue;
    model.jacobian.row(i) += a * (t * weights).cwiseQuotient(radii).transpose();
    Eigen::MatrixXd& hessian = model.hessians[static_cast<std::size_t>(i)];
    hessian = (2 * kCurvatureWeight) * t * weights.asDiagonal() * t.transpose();
    hessian.diagonal().array() += 2 * kMeanCurvatureWeight * squares.dot(weights);
    hessian = (per_radius.asDiagonal() * hessian * per_radius.asDiagonal()).eval();
  }
}

double Distance(const Archive& archive, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseQuotient(archive.lengths()).norm();
}

// The distance within which the neighbours can tell slopes: half that of neighbour number D.
double Sparsity(const Archive& archive, std::size_t centre,
                const std::vector<std::size_t>& neighbours) {
  if (neighbours.empty()) return 0;
  const auto D = static_cast<std::size_t>(archive[centre].u.size());
  const std::size_t last = neighbours[std::min(neighbours.size(), D) - 1];
  return 0.5 * Distance(archive, archive[last].u, archive[centre].u);
}

// Powell's symmetric update of a Hessian by offered gradients, from the farthest neighbour to the
// nearest: H becomes the nearest matrix (Frobenius) with H s = grad f(c + s) - grad f(c).
void UpdateBySecants(const Archive& archive, const ArchiveEntry& centre,
                     const std::vector<std::size_t>& neighbours, const Eigen::VectorXd& radii,
                     const Quantities& modelled, Index row, QuadraticModel& model) {
  Eigen::MatrixXd& H = model.hessians[static_cast<std::size_t>(row)];
  const Eigen::MatrixXd& here = centre.*modelled.jacobian;
  for (auto at = neighbours.rbegin(); at != neighbours.rend(); ++at) {
    const Eigen::MatrixXd& there = archive[*at].*modelled.jacobian;
    if (!OffersGradient(there, row) || !there.row(row).allFinite() || !here.row(row).allFinite()) {
      continue;
    }
    const Eigen::VectorXd s = archive[*at].u - centre.u;
    const double square = s.squaredNorm();
    const double trust = 1 / (1 + 0.1 * s.cwiseQuotient(radii).squaredNorm());
    const Eigen::VectorXd miss = trust * ((there.row(row) - here.row(row)).transpose() - H * s);
    H += (miss * s.transpose() + s * miss.transpose()) / square -
         (s.dot(miss) / (square * square)) * s * s.transpose();
  }
}

}  // namespace

Eigen::VectorXd QuadraticModel::Predict(const Eigen::VectorXd& u) const {
  const Eigen::VectorXd s = u - centre;
  Eigen::VectorXd metrics = value + jacobian * s;
  for (Index i = 0; i < value.size(); ++i) {
    metrics[i] += 0.5 * s.dot(hessians[static_cast<std::size_t>(i)] * s);
  }
  return metrics;
}

Eigen::MatrixXd QuadraticModel::WeightedHessian(const Eigen::VectorXd& weights) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(centre.size(), centre.size());
  for (Index i = 0; i < value.size(); ++i) {
    sum += weights[i] * hessians[static_cast<std::size_t>(i)];
  }
  return sum;
}

std::vector<std::size_t> SpreadNeighbours(const Archive& archive, std::size_t centre,
                                          std::size_t count) {
  const Eigen::VectorXd& c = archive[centre].u;
  std::vector<std::size_t> kept;
  for (const std::size_t candidate : archive.Nearest(c, 4 * count)) {
    if (candidate == centre) continue;
    const Eigen::VectorXd& u = archive[candidate].u;
    const double reach = Distance(archive, u, c);
    if (reach < 1e-12) continue;
    const double least = kThinning * reach;
    const bool crowded = std::any_of(kept.begin(), kept.end(), [&](std::size_t other) {
      return Distance(archive, archive[other].u, u) < least;
    });
    if (crowded) continue;
    kept.push_back(candidate);
    if (kept.size() == count) break;
  }
  return kept;
}

namespace {

QuadraticModel Fit(const Archive& archive, std::size_t centre, double radius,
                   const Eigen::MatrixXd& prior, const Quantities& modelled) {
  const ArchiveEntry& entry = archive[centre];
  const Eigen::VectorXd& values = entry.*modelled.values;
  const Eigen::MatrixXd& jacobian = entry.*modelled.jacobian;
  const Index D = entry.u.size();
  const Index d = values.size();
  QuadraticModel model;
  model.centre = entry.u;
  model.value = values;
  model.jacobian = prior.size() > 0 ? prior : Eigen::MatrixXd::Zero(d, D);
  model.hessians.assign(static_cast<std::size_t>(d), Eigen::MatrixXd::Zero(D, D));
  std::vector<Index> offered, secant;
  for (Index i = 0; i < d; ++i) {
    if (OffersGradient(jacobian, i)) {
      // A slope may be infinite at a bound (a square root at 0): the prior stands in for it.
      for (Index j = 0; j < D; ++j) {
        if (std::isfinite(jacobian(i, j))) model.jacobian(i, j) = jacobian(i, j);
      }
      offered.push_back(i);
    } else {
      secant.push_back(i);
    }
  }
  model.exact_gradients = secant.empty();

  const auto limit = static_cast<std::size_t>(std::min<Index>(2 * D + 10, 60));
  const std::vector<std::size_t> neighbours = SpreadNeighbours(archive, centre, limit);
  const double scale = std::max(radius, Sparsity(archive, centre, neighbours));
  const Eigen::VectorXd radii = scale * archive.lengths();
  const auto m = static_cast<Index>(neighbours.size());
  Eigen::MatrixXd t(D, m);
  Eigen::MatrixXd residuals(d, m);
  for (Index k = 0; k < m; ++k) {
    const ArchiveEntry& other = archive[neighbours[static_cast<std::size_t>(k)]];
    t.col(k) = (other.u - entry.u).cwiseQuotient(radii);
    residuals.col(k) = other.*modelled.values - values - model.jacobian * (other.u - entry.u);
  }
  const Eigen::VectorXd distances = t.colwise().norm();
  const Eigen::VectorXd slack =
      distances.unaryExpr([](double r) { return kInterpolation + kCubicSlack * std::pow(r, 6); });
  FitKernels(t, residuals, slack, 1.0, radii, secant, model);
  FitKernels(t, residuals, slack, 0.0, radii, offered, model);
  for (const Index i : offered) {
    UpdateBySecants(archive, entry, neighbours, radii, modelled, i, model);
  }
  return model;
}

}  // namespace

QuadraticModel FitQuadraticModel(const Archive& archive, std::size_t centre, double radius,
                                 const Eigen::MatrixXd& prior) {
  return Fit(archive, centre, radius, prior, kMetrics);
}

QuadraticModel FitConstraintModel(const Archive& archive, std::size_t centre, double radius,
                                  const Eigen::MatrixXd& prior) {
  return Fit(archive, centre, radius, prior, kConstraints);
}

std::vector<QuadraticFunction> ConstraintsAround(const QuadraticModel& model,
                                                 const Eigen::VectorXd& u,
                                                 const Eigen::VectorXd& sizes) {
  const Eigen::VectorXd values = model.Predict(u), offset = u - model.centre;
  std::vector<QuadraticFunction> constraints;
  for (Index j = 0; j < sizes.size(); ++j) {
    const Eigen::MatrixXd& hessian = model.hessians[static_cast<std::size_t>(j)];
    constraints.push_back({values[j] / sizes[j],
                           (model.jacobian.row(j).transpose() + hessian * offset) / sizes[j],
                           hessian / sizes[j]});
  }
  return constraints;
}

}  // namespace mortise::pareto
