// Says which air is to flow around a design, and how it comes.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"

namespace mortise::parametric {

// The oncoming air.
struct Air {
  double temperature = 288.15;  // K
  double pressure = 101325;     // Pa

  double Density() const;       // kg/m³, of a perfect gas
  double Viscosity() const;     // Pa s (Sutherland, 1893)
  double SpeedOfSound() const;  // m/s
};

inline constexpr double kMolarMassOfAir = 28.9647;  // kg/kmol
inline constexpr double kHeatCapacityOfAir = 1005;  // J/(kg K), at constant pressure

struct Airflow {
  Eigen::Vector3d wind{-10, 0, 0};  // m/s, the way it blows
  Air air = {};
  int cells = 30'000;  // about how many to compute with
};

// Fails with INVALID_ARGUMENT naming all that is wrong of "wind" (1 to 240 m/s, at most 0.7 of the
// speed of sound), "temperature" (150 to 1000 K), "pressure" (1e3 to 1e6 Pa), "cells" (2,000 to
// 5,000,000).
absl::Status CheckAirflow(const Airflow& airflow);

}  // namespace mortise::parametric
