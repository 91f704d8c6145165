// SplitMix64 and the distributions on it.
#include "common/base/random.h"

#include <cmath>
#include <numbers>

namespace mortise {

std::uint64_t Random::Next() {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

double Random::Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }

std::size_t Random::Index(std::size_t count) {
  return static_cast<std::size_t>(Uniform() * static_cast<double>(count));
}

double Random::Normal() {  // Box-Muller
  const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
  return radius * std::cos(2 * std::numbers::pi * Uniform());
}

Eigen::VectorXd Random::UnitVector(Eigen::Index size) {
  Eigen::VectorXd v(size);
  do {
    for (double& value : v) value = Normal();
  } while (v.norm() < 1e-12);
  return v.normalized();
}

}  // namespace mortise
