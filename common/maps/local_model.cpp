#include "common/maps/local_model.h"

#include <Eigen/Cholesky>

namespace mortise::maps {
namespace {

constexpr double kCurvedPenalty = 1e-3;
constexpr double kHigherPenalty = 1e-2;  // beyond that, of z³ and z⁴
constexpr double kLinearPenalty = 1e-9;

Eigen::Index CountOfTerms(Eigen::Index k) { return 1 + 4 * k + k * (k - 1) / 2; }

Eigen::VectorXd Terms(const Eigen::VectorXd& z) {
  const Eigen::Index k = z.size();
  Eigen::VectorXd terms(CountOfTerms(k));
  terms[0] = 1;
  terms.segment(1, k) = z;
  terms.segment(1 + k, k) = z.cwiseAbs2();
  terms.segment(1 + 2 * k, k) = z.array().cube();
  terms.segment(1 + 3 * k, k) = z.array().square().square();
  Eigen::Index at = 1 + 4 * k;
  for (Eigen::Index a = 0; a < k; ++a) {
    for (Eigen::Index b = a + 1; b < k; ++b) terms[at++] = z[a] * z[b];
  }
  return terms;
}

}  // namespace

Eigen::MatrixXd BendingOver(const ElementBox& box, const Eigen::MatrixXd& points,
                            const Eigen::MatrixXd& values) {
  const Eigen::Index dimension = points.rows(), size = CountOfTerms(dimension);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, values.rows());
  const Eigen::VectorXd edges = box.high - box.low;
  for (Eigen::Index n = 0; n < points.cols(); ++n) {
    const Eigen::VectorXd z = (points.col(n) - box.low).cwiseQuotient(edges).array() - 0.5;
    const Eigen::VectorXd terms = Terms(z);
    const double closeness = 1 / (1 + 4 * z.squaredNorm() / static_cast<double>(dimension));
    const double weight = closeness * closeness;
    normal += weight * terms * terms.transpose();
    right += weight * terms * values.col(n).transpose();
  }
  const double scale = normal(0, 0);
  normal.diagonal().array() += kLinearPenalty * scale;
  normal.diagonal().tail(size - 1 - dimension).array() += kCurvedPenalty * scale;
  normal.diagonal().segment(1 + 2 * dimension, 2 * dimension).array() += kHigherPenalty * scale;
  const Eigen::MatrixXd fitted = normal.ldlt().solve(right);
  // Linear interpolation between z = ±1/2 differs at the centre by a / 4 of a z², by a / 16 of a
  // z⁴.
  const Eigen::MatrixXd bending = fitted.middleRows(1 + dimension, dimension) / 4 +
                                  fitted.middleRows(1 + 3 * dimension, dimension) / 16;
  return bending.cwiseAbs();
}

}  // namespace mortise::maps
