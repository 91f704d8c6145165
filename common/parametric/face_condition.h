// A support or load on faces of one solid, at given parameters.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/parametric/template_definition.h"

namespace mortise::parametric {

struct FaceCondition {
  std::string name;
  BoundaryConditionKind kind = BoundaryConditionKind::kFixed;
  std::vector<int> faces;                           // indices of the solid's faces, at least one
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N in all, spread over the faces; kForce
  double pressure = 0;                              // Pa, against the faces; kPressure
  double heat_flux = 0;                             // W/m² into the solid; kHeatFlux
  double temperature = 0;                           // K; kTemperature
};

}  // namespace mortise::parametric
