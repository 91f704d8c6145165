#include "services/retrieval/descriptors/zernike_moments.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace mortise::retrieval {
namespace {

using Complex = std::complex<double>;

// The place of x^p y^r among all powers up to an order: by p + r, then r.
constexpr Eigen::Index PowerPlace(int p, int r) { return (p + r) * (p + r + 1) / 2 + r; }

double Factorial(int n) { return n < 2 ? 1 : n * Factorial(n - 1); }

double Choose(int n, int k) { return Factorial(n) / Factorial(k) / Factorial(n - k); }

// The coefficient of ρ^(n - 2s) in R_nm.
double RadialCoefficient(int n, int m, int s) {
  return (s % 2 ? -1 : 1) * Factorial(n - s) /
         (Factorial(s) * Factorial((n + m) / 2 - s) * Factorial((n - m) / 2 - s));
}

// R_nm(ρ) exp(-i m θ) by powers of x and y: ρ^k exp(-i m θ) is (x - i y)^m (x² + y²)^((k - m) / 2).
Eigen::VectorXcd FunctionByPowers(int n, int m, Eigen::Index powers) {
  Eigen::VectorXcd function = Eigen::VectorXcd::Zero(powers);
  for (int s = 0; s <= (n - m) / 2; ++s) {
    const int squares = (n - 2 * s - m) / 2;
    for (int i = 0; i <= m; ++i) {
      for (int j = 0; j <= squares; ++j) {
        const int r = i + 2 * j, p = n - 2 * s - r;
        function[PowerPlace(p, r)] += RadialCoefficient(n, m, s) * Choose(m, i) *
                                      Choose(squares, j) * std::pow(Complex(0, -1), i);
      }
    }
  }
  return function;
}

}  // namespace

ZernikeMoments::ZernikeMoments(int order) : order_(order) {
  const Eigen::Index powers = PowerPlace(0, order) + 1;
  by_powers_.resize(powers, powers);
  Eigen::Index row = 0;
  for (int n = 0; n <= order; ++n) {
    for (int m = n % 2; m <= n; m += 2) {
      const double weight = std::sqrt((m ? 2 : 1) * (n + 1.0)) / std::numbers::pi;
      const Eigen::VectorXcd function = weight * FunctionByPowers(n, m, powers);
      by_powers_.row(row++) = function.real();
      if (m > 0) by_powers_.row(row++) = -function.imag();
    }
  }
}

Eigen::VectorXd ZernikeMoments::PowerMoments(const Silhouette& silhouette,
                                             const Eigen::Vector2d& centre, double radius) const {
  Eigen::VectorXd moments = Eigen::VectorXd::Zero(PowerPlace(0, order_) + 1);
  Eigen::ArrayXd along(order_ + 1);  // of a row: integrals of x^p
  const auto finish_row = [&](double y) {
    for (int p = 0; p <= order_; ++p) {
      double moment = along[p];
      for (int r = 0; p + r <= order_; ++r, moment *= y) moments[PowerPlace(p, r)] += moment;
    }
  };
  for (std::size_t i = 0; i < silhouette.spans.size();) {
    const double row = silhouette.spans[i].y;
    along.setZero();
    for (; i < silhouette.spans.size() && silhouette.spans[i].y == row; ++i) {
      const double begin = (silhouette.spans[i].begin - centre.x()) / radius;
      const double end = (silhouette.spans[i].end - centre.x()) / radius;
      double begin_power = begin, end_power = end;
      for (int p = 0; p <= order_; ++p, begin_power *= begin, end_power *= end) {
        along[p] += (end_power - begin_power) / (p + 1);
      }
    }
    finish_row((row - centre.y()) / radius);
  }
  return moments * (silhouette.row_height / radius);
}

Eigen::VectorXd ZernikeMoments::Of(const Silhouette& silhouette, const Eigen::Vector2d& centre,
                                   double radius, double turn) const {
  Eigen::VectorXd moments = by_powers_ * PowerMoments(silhouette, centre, radius);
  Eigen::Index place = 0;
  for (int n = 0; n <= order_; ++n) {
    for (int m = n % 2; m <= n; m += 2) {
      if (m > 0) {
        const Complex turned =
            Complex(moments[place], moments[place + 1]) * std::polar(1.0, -m * turn);
        moments[place] = turned.real();
        moments[place + 1] = turned.imag();
      }
      place += m > 0 ? 2 : 1;
    }
  }
  return moments;
}

Eigen::VectorXd ZernikeMoments::MirrorSigns() const {
  // θ becomes π - θ.
  Eigen::VectorXd signs(size());
  Eigen::Index place = 0;
  for (int n = 0; n <= order_; ++n) {
    for (int m = n % 2; m <= n; m += 2) {
      signs[place++] = m % 2 ? -1 : 1;
      if (m > 0) signs[place++] = m % 2 ? 1 : -1;
    }
  }
  return signs;
}

}  // namespace mortise::retrieval
