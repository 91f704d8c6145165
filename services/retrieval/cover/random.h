// Seeded random numbers that are the same with every compiler and library.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace mortise::retrieval {

// The standard's Mersenne Twister, whose numbers are laid down, with distributions of our own, as
// the standard's are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t Next() { return engine_(); }

  // Uniform in [0, 1).
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  // Of the standard normal distribution (Box and Muller).
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * std::numbers::pi * Uniform());
  }

  // Uniform on the unit sphere of R^size; size >= 1.
  Eigen::VectorXd UnitVector(Eigen::Index size) {
    Eigen::VectorXd v(size);
    do {
      for (double& value : v) value = Normal();
    } while (v.norm() < 1e-12);
    return v.normalized();
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mortise::retrieval
