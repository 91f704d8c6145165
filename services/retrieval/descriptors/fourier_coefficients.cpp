#include "services/retrieval/descriptors/fourier_coefficients.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace mortise::retrieval {
namespace {

using Complex = std::complex<double>;

// Adds `factor` times the integrals of exp(ikθ) / |p| along a row, from where x is 0 to a point of
// it.
void AddUpTo(double x, double y, double factor, Eigen::VectorXcd& integrals) {
  const double length = std::hypot(x, y);
  const Complex step(x / length, y / length);  // exp(iθ)
  // ln |tan θ/2|, in the form that does not cancel.
  Complex before = std::log(x > 0 ? std::abs(y) / (length + x) : (length - x) / std::abs(y));
  Complex current(std::log(std::abs(y) / length), std::atan2(y, x));  // ∫ cos θ / sin θ, ∫ 1
  integrals[0] -= factor * before;
  Complex power = step;  // exp(ikθ)
  for (Eigen::Index k = 1; k < integrals.size(); ++k, power *= step) {
    integrals[k] -= factor * current;
    const Complex next = before + 2.0 * power / double(k);
    before = current;
    current = next;
  }
}

}  // namespace

Eigen::VectorXd FourierCoefficients::Of(const Silhouette& silhouette, double turn) const {
  Eigen::VectorXcd integrals = Eigen::VectorXcd::Zero(order_ + 1);
  for (const Span& span : silhouette.spans) {
    AddUpTo(span.end, span.y, 1, integrals);
    AddUpTo(span.begin, span.y, -1, integrals);
  }
  integrals *= silhouette.row_height / (2 * std::numbers::pi);
  Eigen::VectorXd coefficients(size());
  coefficients[0] = integrals[0].real();
  for (int k = 1; k <= order_; ++k) {
    const Complex turned = std::numbers::sqrt2 * integrals[k] * std::polar(1.0, -k * turn);
    coefficients[2 * k - 1] = turned.real();
    coefficients[2 * k] = turned.imag();
  }
  return coefficients;
}

Eigen::VectorXd FourierCoefficients::MirrorSigns() const {
  // θ becomes π - θ.
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(size());
  for (Eigen::Index k = 1; k <= order_; ++k) signs[k % 2 ? 2 * k - 1 : 2 * k] = -1;
  return signs;
}

}  // namespace mortise::retrieval
