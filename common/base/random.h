// Draws seeded random numbers that are the same with every compiler and library.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mortise {

// SplitMix64 (Steele, Lea, Flood 2014). The standard library's distributions may differ between
// implementations, so the few that are needed are defined here.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Next();

  // Draws a number uniformly from [0, 1).
  double Uniform();

  // Draws an index uniformly from 0 .. count-1; count > 0.
  std::size_t Index(std::size_t count);

  // Draws a number from the standard normal distribution.
  double Normal();

  // Draws a vector uniformly from the unit sphere of R^size: both signs in every coordinate.
  Eigen::VectorXd UnitVector(Eigen::Index size);

 private:
  std::uint64_t state_;
};

}  // namespace mortise
