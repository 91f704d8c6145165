// Hyperspherical angles and back.
#include "services/pareto/archive/embedding.h"

#include <cmath>
#include <numbers>

namespace mortise::pareto {

Eigen::VectorXd Embed(const Eigen::VectorXd& scaled) {
  const Eigen::VectorXd y = scaled.cwiseMax(0.0);
  Eigen::VectorXd embedding(y.size() - 1);
  for (Eigen::Index k = 0; k < embedding.size(); ++k) {
    embedding[k] = std::atan2(y.tail(y.size() - 1 - k).norm(), y[k]) / (std::numbers::pi / 2);
  }
  return embedding;
}

Eigen::MatrixXd RaysAt(const Eigen::MatrixXd& embedding) {
  const Eigen::Index angles = embedding.rows();
  Eigen::MatrixXd rays(angles + 1, embedding.cols());
  for (Eigen::Index i = 0; i < embedding.cols(); ++i) {
    double rest = 1;
    for (Eigen::Index k = 0; k < angles; ++k) {
      const double angle = embedding(k, i) * std::numbers::pi / 2;
      rays(k, i) = rest * std::cos(angle);
      rest *= std::sin(angle);
    }
    rays(angles, i) = rest;
  }
  return rays;
}

int NeighboursOnFront(Eigen::Index d) { return static_cast<int>(2 * d); }

}  // namespace mortise::pareto
