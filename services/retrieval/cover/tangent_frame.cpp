// Singular vectors, and greedy turning of them towards what bounds them most.
#include "services/retrieval/cover/tangent_frame.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/base/errors.h"
#include "services/retrieval/cover/constrained_step.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNegligible = 0.1;  // of δ: what a direction must move the descriptor by
constexpr double kSingular = 1e-6;   // of the largest singular value
constexpr double kNothing = 1e-12;   // of a unit vector's projection: no direction at all
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The distance to the nearest constraint along a unit direction, in either sense.
double NearestBoundary(const MatrixXd& rates, const VectorXd& slacks, const VectorXd& direction) {
  double nearest = kInfinity;
  const VectorXd along = rates * direction;
  for (Index i = 0; i < along.size(); ++i) {
    if (along[i] != 0) nearest = std::min(nearest, slacks[i] / std::abs(along[i]));
  }
  return nearest;
}

// Unit vectors in the span of `left`'s columns that a constraint or a parameter points along.
std::vector<VectorXd> Candidates(const MatrixXd& left, const MatrixXd& rates,
                                 const MatrixXd& parameter_moves) {
  std::vector<VectorXd> candidates;
  const auto add = [&](const VectorXd& vector) {
    const VectorXd within = left.transpose() * vector;
    if (within.norm() > kNothing * std::max(1.0, vector.norm()) && within.norm() > 0) {
      candidates.emplace_back(left * within.normalized());
    }
  };
  for (Index i = 0; i < rates.rows(); ++i) add(rates.row(i).transpose());
  for (Index k = 0; k < parameter_moves.cols(); ++k) add(parameter_moves.col(k));
  if (candidates.empty()) candidates.emplace_back(left.col(0));
  return candidates;
}

// An orthonormal basis of what is orthogonal to `direction` in the span of `left`.
MatrixXd Without(const MatrixXd& left, const VectorXd& direction) {
  const VectorXd within = left.transpose() * direction;
  const MatrixXd full = Eigen::HouseholderQR<MatrixXd>(within).householderQ();
  return left * full.rightCols(left.cols() - 1);
}

}  // namespace

TangentFrame::TangentFrame(const LinearConstraints& constraints, const VectorXd& q,
                           const Derivatives& derivatives, const VectorXd& extents, double delta,
                           double error)
    : constraints_(constraints), q_(q), extents_(extents) {
  const MatrixXd scaled = derivatives.first * extents.asDiagonal();
  const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeFullV);
  const VectorXd& sizes = svd.singularValues();
  const double least = std::max(std::max(kSingular, 2 * error) * sizes[0], kNegligible * delta);
  Index rank = 0;
  while (rank < sizes.size() && sizes[rank] > least) ++rank;
  basis_ = svd.matrixU().leftCols(rank);
  const MatrixXd back = svd.matrixV().leftCols(rank) * sizes.head(rank).cwiseInverse().asDiagonal();
  changes_ = extents.asDiagonal() * back;
  idle_ = extents.asDiagonal() * svd.matrixV().rightCols(q.size() - rank);
  bends_ = derivatives.second - basis_ * (basis_.transpose() * derivatives.second);
  if (rank == 0) return;
  Orient(derivatives, (constraints.bounds - constraints.normals * q).cwiseMax(0), delta);
  moves_ = basis_.transpose() * derivatives.first;
}

// Thesis §4.4.2: the direction that is bounded most becomes an axis, then again in what is
// orthogonal to it. Among half-spaces the nearest boundary is along a normal, so the normals are
// the directions to try; the parameters are added for what curvature bounds.
void TangentFrame::Orient(const Derivatives& derivatives, const VectorXd& slacks, double delta) {
  const Index rank = basis_.cols();
  const MatrixXd rates = constraints_.normals * changes_;
  const MatrixXd moves = basis_.transpose() * derivatives.first;
  MatrixXd left = MatrixXd::Identity(rank, rank);
  std::vector<VectorXd> axes;
  std::vector<std::pair<double, double>> radii;  // predicted, by curvature alone
  while (left.cols() > 0) {
    VectorXd best;
    std::pair<double, double> least = {kInfinity, kInfinity};
    for (const VectorXd& direction : Candidates(left, rates, moves)) {
      const double curvature = CurvatureRadius(direction, delta);
      const double boundary = NearestBoundary(rates, slacks, direction) + delta;
      const double radius = std::max(delta, std::min(curvature, boundary));
      if (best.size() > 0 && radius >= least.first) continue;
      best = direction;
      least = {radius, curvature};
    }
    axes.push_back(best);
    radii.push_back(least);
    left = Without(left, best);
  }
  std::vector<std::size_t> order(axes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
  MatrixXd turn(rank, rank);
  predicted_.resize(rank);
  curvature_.resize(rank);
  for (Index i = 0; i < rank; ++i) {
    const std::size_t from = order[static_cast<std::size_t>(i)];
    turn.col(i) = axes[from];
    predicted_[i] = radii[from].first;
    curvature_[i] = radii[from].second;
  }
  basis_ *= turn;
  changes_ *= turn;
}

double TangentFrame::CurvatureRadius(const VectorXd& direction, double delta) const {
  const VectorXd change = changes_ * direction;
  const double curvature = (bends_ * change.cwiseAbs2()).norm();
  return curvature > 0 ? std::sqrt(2 * delta / curvature) : kInfinity;
}

absl::StatusOr<VectorXd> TangentFrame::StepFrom(const VectorXd& from, const VectorXd& move) const {
  return ConstrainedStep(constraints_, q_ + from, moves_, extents_, move);
}

absl::StatusOr<Way> TangentFrame::WayAlong(const VectorXd& move) const {
  const VectorXd change = changes_ * move;
  const double size = move.norm();
  const double room = RoomAlong(constraints_, q_, change);
  if (idle_.cols() == 0 || std::isinf(room)) return Way{room * change, room * size};
  // The furthest t of t · change + idle · c within the constraints.
  const VectorXd slacks = (constraints_.bounds - constraints_.normals * q_).cwiseMax(0);
  MatrixXd rows(slacks.size(), 1 + idle_.cols());
  rows << constraints_.normals * change, constraints_.normals * idle_;
  MORTISE_ASSIGN_OR_RETURN(auto programme, parametric::LinearProgramme::Create(rows, slacks));
  MORTISE_ASSIGN_OR_RETURN(const auto furthest, programme.Furthest(VectorXd::Unit(rows.cols(), 0)));
  if (!furthest || (*furthest)[0] <= room) return Way{room * change, room * size};
  Way way{(*furthest)[0] * change + idle_ * furthest->tail(idle_.cols()), (*furthest)[0] * size};
  // The programme keeps constraints but for rounding; designs are evaluated only where they hold.
  const double part = std::min(1.0, RoomAlong(constraints_, q_, way.change));
  return Way{part * way.change, part * way.length};
}

Index AxesThatPay(const VectorXd& radii, double delta) {
  Index best = 0;
  double most = 1, product = 1;
  for (Index m = 1; m <= radii.size(); ++m) {
    product *= std::max(1.0, radii[m - 1] / delta);
    const double worth = product / static_cast<double>(m + 1);
    if (worth > most) {
      most = worth;
      best = m;
    }
  }
  return best;
}

}  // namespace mortise::retrieval
