#include "services/retrieval/cover/radial_interpolant.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPointsATerm = 2;           // at least
constexpr Index kPointsAQuadraticTerm = 3;  // for a quadratic polynomial
constexpr double kSingular = 1e-14;         // reciprocal condition

Index LinearTerms(Index size) { return 1 + size; }
Index QuadraticTerms(Index size) { return 1 + size + size * (size + 1) / 2; }

// The polynomial's terms at x: 1, x, and where there are more, products of two.
VectorXd TermsAt(const VectorXd& x, Index terms) {
  VectorXd result(terms);
  result[0] = 1;
  result.segment(1, x.size()) = x;
  Index next = 1 + x.size();
  if (next == terms) return result;
  for (Index i = 0; i < x.size(); ++i) {
    for (Index j = i; j < x.size(); ++j) result[next++] = x[i] * x[j];
  }
  return result;
}

}  // namespace

absl::StatusOr<RadialInterpolant> RadialInterpolant::Fit(MatrixXd points, const MatrixXd& values,
                                                         double smoothing) {
  const Index count = points.cols(), size = points.rows();
  if (values.cols() != count) return InvalidField("values", "must be one for each point");
  const bool is_quadratic = count >= kPointsAQuadraticTerm * QuadraticTerms(size);
  const Index terms = is_quadratic ? QuadraticTerms(size) : LinearTerms(size);
  if (count < kPointsATerm * terms) {
    return PreconditionFailed("TOO_FEW_POINTS", "there are too few points to interpolate");
  }
  MatrixXd system = MatrixXd::Zero(count + terms, count + terms);
  for (Index i = 0; i < count; ++i) {
    const VectorXd distances = (points.colwise() - points.col(i)).colwise().norm();
    system.col(i).head(count) = distances.array().cube();
    system(i, i) += smoothing;
    const VectorXd polynomial = TermsAt(points.col(i), terms);
    system.col(i).tail(terms) = polynomial;
    system.row(i).tail(terms) = polynomial.transpose();
  }
  const Eigen::PartialPivLU<MatrixXd> factors(system);
  if (!(factors.rcond() > kSingular)) {
    return PreconditionFailed("TOO_FEW_POINTS", "the points do not determine a polynomial");
  }
  const MatrixXd inverse = factors.inverse();
  RadialInterpolant made;
  made.coefficients_ = values * inverse.topRows(count);
  made.left_out_errors_ =
      made.coefficients_.leftCols(count).colwise().norm().transpose().cwiseQuotient(
          inverse.diagonal().head(count).cwiseAbs());
  made.points_ = std::move(points);
  made.terms_ = terms;
  return made;
}

VectorXd RadialInterpolant::At(const VectorXd& x) const {
  VectorXd basis(points_.cols() + terms_);
  basis.head(points_.cols()) = (points_.colwise() - x).colwise().norm().transpose().array().cube();
  basis.tail(terms_) = TermsAt(x, terms_);
  return coefficients_ * basis;
}

}  // namespace mortise::retrieval
